(function(){"use strict";var ma,et,lf,cf,Ii,uf,ff,df,dl,ga,Ts,hf,hl,pl,ml,_a={},va=[],_m=/acit|ex(?:s|g|n|p|$)|rph|grid|ows|mnc|ntw|ine[ch]|zoo|^ord|itera/i,xa=Array.isArray;function oi(n,e){for(var t in e)n[t]=e[t];return n}function gl(n){n&&n.parentNode&&n.parentNode.removeChild(n)}function pf(n,e,t){var i,r,s,a={};for(s in e)s=="key"?i=e[s]:s=="ref"?r=e[s]:a[s]=e[s];if(arguments.length>2&&(a.children=arguments.length>3?ma.call(arguments,2):t),typeof n=="function"&&n.defaultProps!=null)for(s in n.defaultProps)a[s]===void 0&&(a[s]=n.defaultProps[s]);return Sa(n,a,i,r,null)}function Sa(n,e,t,i,r){var s={type:n,props:e,key:t,ref:i,__k:null,__:null,__b:0,__e:null,__c:null,constructor:void 0,__v:r??++lf,__i:-1,__u:0};return r==null&&et.vnode!=null&&et.vnode(s),s}function ht(n){return n.children}function As(n,e){this.props=n,this.context=e}function ar(n,e){if(e==null)return n.__?ar(n.__,n.__i+1):null;for(var t;e<n.__k.length;e++)if((t=n.__k[e])!=null&&t.__e!=null)return t.__e;return typeof n.type=="function"?ar(n):null}function vm(n){if(n.__P&&n.__d){var e=n.__v,t=e.__e,i=[],r=[],s=oi({},e);s.__v=e.__v+1,et.vnode&&et.vnode(s),_l(n.__P,s,e,n.__n,n.__P.namespaceURI,32&e.__u?[t]:null,i,t??ar(e),!!(32&e.__u),r),s.__v=e.__v,s.__.__k[s.__i]=s,yf(i,s,r),e.__e=e.__=null,s.__e!=t&&mf(s)}}function mf(n){if((n=n.__)!=null&&n.__c!=null)return n.__e=n.__c.base=null,n.__k.some(function(e){if(e!=null&&e.__e!=null)return n.__e=n.__c.base=e.__e}),mf(n)}function gf(n){(!n.__d&&(n.__d=!0)&&Ii.push(n)&&!Ma.__r++||uf!=et.debounceRendering)&&((uf=et.debounceRendering)||ff)(Ma)}function Ma(){try{for(var n,e=1;Ii.length;)Ii.length>e&&Ii.sort(df),n=Ii.shift(),e=Ii.length,vm(n)}finally{Ii.length=Ma.__r=0}}function _f(n,e,t,i,r,s,a,o,l,c,f){var d,u,h,g,x,m,p=i&&i.__k||va,v=e.length;for(l=xm(t,e,p,l,v),d=0;d<v;d++)(h=t.__k[d])!=null&&(u=h.__i!=-1&&p[h.__i]||_a,h.__i=d,m=_l(n,h,u,r,s,a,o,l,c,f),g=h.__e,h.ref&&u.ref!=h.ref&&(u.ref&&vl(u.ref,null,h),f.push(h.ref,h.__c||g,h)),x==null&&g!=null&&(x=g),4&h.__u?(l=vf(h,l,n),u.__e&&(u.__e=null)):typeof h.type=="function"&&m!==void 0?l=m:g&&(l=g.nextSibling),h.__u&=-7);return t.__e=x,l}function xm(n,e,t,i,r){var s,a,o,l,c,f=t.length,d=f,u=0;for(n.__k=new Array(r),s=0;s<r;s++)(a=e[s])!=null&&typeof a!="boolean"&&typeof a!="function"?(typeof a=="string"||typeof a=="number"||typeof a=="bigint"||a.constructor==String?a=n.__k[s]=Sa(null,a,null,null,null):xa(a)?a=n.__k[s]=Sa(ht,{children:a},null,null,null):a.constructor===void 0&&a.__b>0?a=n.__k[s]=Sa(a.type,a.props,a.key,a.ref?a.ref:null,a.__v):n.__k[s]=a,l=s+u,a.__=n,a.__b=n.__b+1,o=null,(c=a.__i=Sm(a,t,l,d))!=-1&&(d--,(o=t[c])&&(o.__u|=2)),o==null||o.__v==null?(c==-1&&(r>f?u--:r<f&&u++),typeof a.type!="function"&&(a.__u|=4)):c!=l&&(c==l-1?u--:c==l+1?u++:(c>l?u--:u++,a.__u|=4))):n.__k[s]=null;if(d)for(s=0;s<f;s++)(o=t[s])!=null&&(2&o.__u)==0&&(o.__e==i&&(i=ar(o)),Ef(o,o));return i}function vf(n,e,t){var i,r;if(typeof n.type=="function"){for(i=n.__k,r=0;i&&r<i.length;r++)i[r]&&(i[r].__=n,e=vf(i[r],e,t));return e}n.__e!=e&&(e&&n.type&&!e.parentNode&&(e=ar(n)),e=t.insertBefore(n.__e,e||null));do e=e&&e.nextSibling;while(e!=null&&e.nodeType==8);return e}function Sm(n,e,t,i){var r,s,a,o=n.key,l=n.type,c=e[t],f=c!=null&&(2&c.__u)==0;if(c===null&&o==null||f&&o==c.key&&l==c.type)return t;if(i>(f?1:0)){for(r=t-1,s=t+1;r>=0||s<e.length;)if((c=e[a=r>=0?r--:s++])!=null&&(2&c.__u)==0&&o==c.key&&l==c.type)return a}return-1}function xf(n,e,t){e[0]=="-"?n.setProperty(e,t??""):n[e]=t==null?"":typeof t!="number"||_m.test(e)?t:t+"px"}function ya(n,e,t,i,r){var s,a;e:if(e=="style")if(typeof t=="string")n.style.cssText=t;else{if(typeof i=="string"&&(n.style.cssText=i=""),i)for(e in i)t&&e in t||xf(n.style,e,"");if(t)for(e in t)i&&t[e]==i[e]||xf(n.style,e,t[e])}else if(e[0]=="o"&&e[1]=="n")s=e!=(e=e.replace(hf,"$1")),a=e.toLowerCase(),e=a in n||e=="onFocusOut"||e=="onFocusIn"?a.slice(2):e.slice(2),n.l||(n.l={}),n.l[e+s]=t,t?i?t[Ts]=i[Ts]:(t[Ts]=hl,n.addEventListener(e,s?ml:pl,s)):n.removeEventListener(e,s?ml:pl,s);else{if(r=="http://www.w3.org/2000/svg")e=e.replace(/xlink(H|:h)/,"h").replace(/sName$/,"s");else if(e!="width"&&e!="height"&&e!="href"&&e!="list"&&e!="form"&&e!="tabIndex"&&e!="download"&&e!="rowSpan"&&e!="colSpan"&&e!="role"&&e!="popover"&&e in n)try{n[e]=t??"";break e}catch{}typeof t=="function"||(t==null||t===!1&&e[4]!="-"?n.removeAttribute(e):n.setAttribute(e,e=="popover"&&t==1?"":t))}}function Sf(n){return function(e){if(this.l){var t=this.l[e.type+n];if(e[ga]==null)e[ga]=hl++;else if(e[ga]<t[Ts])return;return t(et.event?et.event(e):e)}}}function _l(n,e,t,i,r,s,a,o,l,c){var f,d,u,h,g,x,m,p,v,y,S,E,A,_,b,I,R=e.type;if(e.constructor!==void 0)return null;128&t.__u&&(l=!!(32&t.__u),s=[o=e.__e=t.__e]),(f=et.__b)&&f(e);e:if(typeof R=="function"){d=a.length;try{if(v=e.props,y=R.prototype&&R.prototype.render,S=(f=R.contextType)&&i[f.__c],E=f?S?S.props.value:f.__:i,t.__c?p=(u=e.__c=t.__c).__=u.__E:(y?e.__c=u=new R(v,E):(e.__c=u=new As(v,E),u.constructor=R,u.render=ym),S&&S.sub(u),u.state||(u.state={}),u.__n=i,h=u.__d=!0,u.__h=[],u._sb=[]),y&&u.__s==null&&(u.__s=u.state),y&&R.getDerivedStateFromProps!=null&&(u.__s==u.state&&(u.__s=oi({},u.__s)),oi(u.__s,R.getDerivedStateFromProps(v,u.__s))),g=u.props,x=u.state,u.__v=e,h)y&&R.getDerivedStateFromProps==null&&u.componentWillMount!=null&&u.componentWillMount(),y&&u.componentDidMount!=null&&u.__h.push(u.componentDidMount);else{if(y&&R.getDerivedStateFromProps==null&&v!==g&&u.componentWillReceiveProps!=null&&u.componentWillReceiveProps(v,E),e.__v==t.__v||!u.__e&&u.shouldComponentUpdate!=null&&u.shouldComponentUpdate(v,u.__s,E)===!1){e.__v!=t.__v&&(u.props=v,u.state=u.__s,u.__d=!1),e.__e=t.__e,e.__k=t.__k,e.__k.some(function(P){P&&(P.__=e)}),va.push.apply(u.__h,u._sb),u._sb=[],u.__h.length&&a.push(u),o=ar(t);break e}u.componentWillUpdate!=null&&u.componentWillUpdate(v,u.__s,E),y&&u.componentDidUpdate!=null&&u.__h.push(function(){u.componentDidUpdate(g,x,m)})}if(u.context=E,u.props=v,u.__P=n,u.__e=!1,A=et.__r,_=0,y)u.state=u.__s,u.__d=!1,A&&A(e),f=u.render(u.props,u.state,u.context),va.push.apply(u.__h,u._sb),u._sb=[];else do u.__d=!1,A&&A(e),f=u.render(u.props,u.state,u.context),u.state=u.__s;while(u.__d&&++_<25);u.state=u.__s,u.getChildContext!=null&&(i=oi(oi({},i),u.getChildContext())),y&&!h&&u.getSnapshotBeforeUpdate!=null&&(m=u.getSnapshotBeforeUpdate(g,x)),b=f!=null&&f.type===ht&&f.key==null?bf(f.props.children):f,o=_f(n,xa(b)?b:[b],e,t,i,r,s,a,o,l,c),u.base=e.__e,e.__u&=-161,u.__h.length&&a.push(u),p&&(u.__E=u.__=null)}catch(P){if(a.length=d,e.__v=null,l||s!=null){if(P.then){for(e.__u|=l?160:128;o&&o.nodeType==8&&o.nextSibling;)o=o.nextSibling;s!=null&&(s[s.indexOf(o)]=null),e.__e=o}else if(s!=null)for(I=s.length;I--;)gl(s[I])}else e.__e=t.__e;e.__k==null&&(e.__k=t.__k||[]),P.then||Mf(e),et.__e(P,e,t)}}else s==null&&e.__v==t.__v?(e.__k=t.__k,e.__e=t.__e):o=e.__e=Mm(t.__e,e,t,i,r,s,a,l,c);return(f=et.diffed)&&f(e),128&e.__u?void 0:o}function Mf(n){n&&(n.__c&&(n.__c.__e=!0),n.__k&&n.__k.some(Mf))}function yf(n,e,t){for(var i=0;i<t.length;i++)vl(t[i],t[++i],t[++i]);et.__c&&et.__c(e,n),n.some(function(r){try{n=r.__h,r.__h=[],n.some(function(s){s.call(r)})}catch(s){et.__e(s,r.__v)}})}function bf(n){return typeof n!="object"||n==null||n.__b>0?n:xa(n)?n.map(bf):n.constructor!==void 0?null:oi({},n)}function Mm(n,e,t,i,r,s,a,o,l){var c,f,d,u,h,g,x,m=t.props||_a,p=e.props,v=e.type;if(v=="svg"?r="http://www.w3.org/2000/svg":v=="math"?r="http://www.w3.org/1998/Math/MathML":r||(r="http://www.w3.org/1999/xhtml"),s!=null){for(c=0;c<s.length;c++)if((h=s[c])&&"setAttribute"in h==!!v&&(v?h.localName==v:h.nodeType==3)){n=h,s[c]=null;break}}if(n==null){if(v==null)return document.createTextNode(p);n=document.createElementNS(r,v,p.is&&p),o&&(et.__m&&et.__m(e,s),o=!1),s=null}if(v==null)m===p||o&&n.data==p||(n.data=p);else{if(s=v=="textarea"&&p.defaultValue!=null?null:s&&ma.call(n.childNodes),!o&&s!=null)for(m={},c=0;c<n.attributes.length;c++)m[(h=n.attributes[c]).name]=h.value;for(c in m)h=m[c],c=="dangerouslySetInnerHTML"?d=h:c=="children"||c in p||c=="value"&&"defaultValue"in p||c=="checked"&&"defaultChecked"in p||ya(n,c,null,h,r);for(c in p)h=p[c],c=="children"?u=h:c=="dangerouslySetInnerHTML"?f=h:c=="value"?g=h:c=="checked"?x=h:o&&typeof h!="function"||m[c]===h||ya(n,c,h,m[c],r);if(f)o||d&&(f.__html==d.__html||f.__html==n.innerHTML)||(n.innerHTML=f.__html),e.__k=[];else if(d&&(n.innerHTML=""),_f(e.type=="template"?n.content:n,xa(u)?u:[u],e,t,i,v=="foreignObject"?"http://www.w3.org/1999/xhtml":r,s,a,s?s[0]:t.__k&&ar(t,0),o,l),s!=null)for(c=s.length;c--;)gl(s[c]);o&&v!="textarea"||(c="value",v=="progress"&&g==null?n.removeAttribute("value"):g!=null&&(g!==n[c]||v=="progress"&&!g||v=="option"&&g!=m[c])&&ya(n,c,g,m[c],r),c="checked",x!=null&&x!=n[c]&&ya(n,c,x,m[c],r))}return n}function vl(n,e,t){try{if(typeof n=="function"){var i=typeof n.__u=="function";i&&n.__u(),i&&e==null||(n.__u=n(e))}else n.current=e}catch(r){et.__e(r,t)}}function Ef(n,e,t){var i,r;if(et.unmount&&et.unmount(n),(i=n.ref)&&(i.current&&i.current!=n.__e||vl(i,null,e)),(i=n.__c)!=null){if(i.componentWillUnmount)try{i.componentWillUnmount()}catch(s){et.__e(s,e)}i.base=i.__P=i.__n=null}if(i=n.__k)for(r=0;r<i.length;r++)i[r]&&Ef(i[r],e,t||typeof n.type!="function");t||gl(n.__e),n.__c=n.__=n.__e=void 0}function ym(n,e,t){return this.constructor(n,t)}function bm(n,e,t){var i,r,s,a;e==document&&(e=document.documentElement),et.__&&et.__(n,e),r=(i=!1)?null:e.__k,s=[],a=[],_l(e,n=e.__k=pf(ht,null,[n]),r||_a,_a,e.namespaceURI,r?null:e.firstChild?ma.call(e.childNodes):null,s,r?r.__e:e.firstChild,i,a),yf(s,n,a),n.props.children=null}ma=va.slice,et={__e:function(n,e,t,i){for(var r,s,a;e=e.__;)if((r=e.__c)&&!r.__)try{if((s=r.constructor)&&s.getDerivedStateFromError!=null&&(r.setState(s.getDerivedStateFromError(n)),a=r.__d),r.componentDidCatch!=null&&(r.componentDidCatch(n,i||{}),a=r.__d),a)return r.__E=r}catch(o){n=o}throw n}},lf=0,cf=function(n){return n!=null&&n.constructor===void 0},As.prototype.setState=function(n,e){var t;t=this.__s!=null&&this.__s!=this.state?this.__s:this.__s=oi({},this.state),typeof n=="function"&&(n=n(oi({},t),this.props)),n&&oi(t,n),n!=null&&this.__v&&(e&&this._sb.push(e),gf(this))},As.prototype.forceUpdate=function(n){this.__v&&(this.__e=!0,n&&this.__h.push(n),gf(this))},As.prototype.render=ht,Ii=[],ff=typeof Promise=="function"?Promise.prototype.then.bind(Promise.resolve()):setTimeout,df=function(n,e){return n.__v.__b-e.__v.__b},Ma.__r=0,dl=Math.random().toString(8),ga="__d"+dl,Ts="__a"+dl,hf=/(PointerCapture)$|Capture$/i,hl=0,pl=Sf(!1),ml=Sf(!0);var Em=0;function M(n,e,t,i,r,s){e||(e={});var a,o,l=e;if("ref"in l)for(o in l={},e)o=="ref"?a=e[o]:l[o]=e[o];var c={type:n,props:l,key:t,ref:a,__k:null,__:null,__b:0,__e:null,__c:null,constructor:void 0,__v:--Em,__i:-1,__u:0,__source:r,__self:s};if(typeof n=="function"&&(a=n.defaultProps))for(o in a)l[o]===void 0&&(l[o]=a[o]);return et.vnode&&et.vnode(c),c}var Rs,Qt,xl,wf,Sl=0,Tf=[],vt=et,Af=vt.__b,Rf=vt.__r,Cf=vt.diffed,Pf=vt.__c,Lf=vt.unmount,Df=vt.__;function Ml(n,e){vt.__h&&vt.__h(Qt,n,Sl||e),Sl=0;var t=Qt.__H||(Qt.__H={__:[],__h:[]});return n>=t.__.length&&t.__.push({}),t.__[n]}function or(n,e){var t=Ml(Rs++,3);!vt.__s&&El(t.__H,e)&&(t.__=n,t.u=e,Qt.__H.__h.push(t))}function wm(n,e){var t=Ml(Rs++,4);!vt.__s&&El(t.__H,e)&&(t.__=n,t.u=e,Qt.__h.push(t))}function li(n){return Sl=5,yl(function(){return{current:n}},[])}function yl(n,e){var t=Ml(Rs++,7);return El(t.__H,e)&&(t.__=n(),t.__H=e,t.__h=n),t.__}function Tm(){for(var n;n=Tf.shift();){var e=n.__H;if(n.__P&&e)try{e.__h.some(ba),e.__h.some(bl),e.__h=[]}catch(t){e.__h=[],vt.__e(t,n.__v)}}}vt.__b=function(n){Qt=null,Af&&Af(n)},vt.__=function(n,e){n&&e.__k&&e.__k.__m&&(n.__m=e.__k.__m),Df&&Df(n,e)},vt.__r=function(n){Rf&&Rf(n),Rs=0;var e=(Qt=n.__c).__H;e&&(xl===Qt?(e.__h=[],Qt.__h=[],e.__.some(function(t){t.__N&&(t.__=t.__N),t.u=t.__N=void 0})):(e.__h.some(ba),e.__h.some(bl),e.__h=[],Rs=0)),xl=Qt},vt.diffed=function(n){Cf&&Cf(n);var e=n.__c;e&&e.__H&&(e.__H.__h.length&&(Tf.push(e)!==1&&wf===vt.requestAnimationFrame||((wf=vt.requestAnimationFrame)||Am)(Tm)),e.__H.__.some(function(t){t.u&&(t.__H=t.u,t.u=void 0)})),xl=Qt=null},vt.__c=function(n,e){e.some(function(t){try{t.__h.some(ba),t.__h=t.__h.filter(function(i){return!i.__||bl(i)})}catch(i){e.some(function(r){r.__h&&(r.__h=[])}),e=[],vt.__e(i,t.__v)}}),Pf&&Pf(n,e)},vt.unmount=function(n){Lf&&Lf(n);var e,t=n.__c;t&&t.__H&&(t.__H.__.some(function(i){try{ba(i)}catch(r){e=r}}),t.__H=void 0,e&&vt.__e(e,t.__v))};var If=typeof requestAnimationFrame=="function";function Am(n){var e,t=function(){clearTimeout(i),If&&cancelAnimationFrame(e),setTimeout(n)},i=setTimeout(t,35);If&&(e=requestAnimationFrame(t))}function ba(n){var e=Qt,t=n.__c;typeof t=="function"&&(n.__c=void 0,t()),Qt=e}function bl(n){var e=Qt;n.__c=n.__(),Qt=e}function El(n,e){return!n||n.length!==e.length||e.some(function(t,i){return t!==n[i]})}var Rm=Symbol.for("preact-signals");function Ea(){if(ci>1)ci--;else{var n,e=!1;for((function(){var r=Ta;for(Ta=void 0;r!==void 0;){var s=r.S;if(s.v===r.v)for(var a=s.t;a!==void 0;a=a.x)a.i===r.i&&(a.i=s.i);r=r.o}})();Ds!==void 0;){var t=Ds;for(Ds=void 0,wa++;t!==void 0;){var i=t.u;if(t.u=void 0,t.f&=-3,!(8&t.f)&&Uf(t))try{t.c()}catch(r){e||(n=r,e=!0)}t=i}}if(wa=0,ci--,e)throw n}}function Cs(n){if(ci>0)return n();wl=++Cm,ci++;try{return n()}finally{Ea()}}var Ps,ut=void 0;function Ls(n){var e=ut,t=Ps;ut=void 0,Ps=void 0;try{return n()}finally{ut=e,Ps=t}}var Ds=void 0,ci=0,wa=0,Cm=0,wl=0,Ta=void 0,Aa=0;function Nf(n){if(ut!==void 0){var e=n.n;if(e===void 0||e.t!==ut)return e={i:0,S:n,p:ut.s,n:void 0,t:ut,e:void 0,x:void 0,r:e},ut.s!==void 0&&(ut.s.n=e),ut.s=e,n.n=e,32&ut.f&&n.S(e),e;if(e.i===-1)return e.i=0,e.n!==void 0&&(e.n.p=e.p,e.p!==void 0&&(e.p.n=e.n),e.p=ut.s,e.n=void 0,ut.s.n=e,ut.s=e),e}}function Bt(n,e){this.v=n,this.i=0,this.n=void 0,this.t=void 0,this.l=0,this.W=e?.watched,this.Z=e?.unwatched,this.name=e?.name}Bt.prototype.brand=Rm,Bt.prototype.h=function(){return!0},Bt.prototype.S=function(n){var e=this,t=this.t;t!==n&&n.e===void 0&&(n.x=t,this.t=n,t!==void 0?t.e=n:Ls(function(){var i;(i=e.W)==null||i.call(e)}))},Bt.prototype.U=function(n){var e=this;if(this.t!==void 0){var t=n.e,i=n.x;t!==void 0&&(t.x=i,n.e=void 0),i!==void 0&&(i.e=t,n.x=void 0),n===this.t&&(this.t=i,i===void 0&&Ls(function(){var r;(r=e.Z)==null||r.call(e)}))}},Bt.prototype.subscribe=function(n){var e=this;return Hn(function(){var t=e.value;Ls(function(){return n(t)})},{name:"sub"})},Bt.prototype.valueOf=function(){return this.value},Bt.prototype.toString=function(){return this.value+""},Bt.prototype.toJSON=function(){return this.value},Bt.prototype.peek=function(){var n=this;return Ls(function(){return n.value})},Object.defineProperty(Bt.prototype,"value",{get:function(){var n=Nf(this);return n!==void 0&&(n.i=this.i),this.v},set:function(n){if(n!==this.v){if(wa>100)throw new Error("Cycle detected");(function(t){ci!==0&&wa===0&&t.l!==wl&&(t.l=wl,Ta={S:t,v:t.v,i:t.i,o:Ta})})(this),this.v=n,this.i++,Aa++,ci++;try{for(var e=this.t;e!==void 0;e=e.x)e.t.N()}finally{Ea()}}}});function Ve(n,e){return new Bt(n,e)}function Uf(n){for(var e=n.s;e!==void 0;e=e.n)if(e.S.i!==e.i||!e.S.h()||e.S.i!==e.i)return!0;return!1}function Ff(n){for(var e=n.s;e!==void 0;e=e.n){var t=e.S.n;if(t!==void 0&&(e.r=t),e.S.n=e,e.i=-1,e.n===void 0){n.s=e;break}}}function Of(n){for(var e=n.s,t=void 0;e!==void 0;){var i=e.p;e.i===-1?(e.S.U(e),i!==void 0&&(i.n=e.n),e.n!==void 0&&(e.n.p=i)):t=e,e.S.n=e.r,e.r!==void 0&&(e.r=void 0),e=i}n.s=t}function lr(n,e){Bt.call(this,void 0,e),this.x=n,this.s=void 0,this.g=Aa-1,this.f=4}lr.prototype=new Bt,lr.prototype.h=function(){if(this.f&=-3,1&this.f)return!1;if((36&this.f)==32||(this.f&=-5,this.g===Aa))return!0;if(this.g=Aa,this.f|=1,this.i>0&&!Uf(this))return this.f&=-2,!0;var n=ut;try{Ff(this),ut=this;var e=this.x();(16&this.f||this.v!==e||this.i===0)&&(this.v=e,this.f&=-17,this.i++)}catch(t){this.v=t,this.f|=16,this.i++}return ut=n,Of(this),this.f&=-2,!0},lr.prototype.S=function(n){if(this.t===void 0){this.f|=36;for(var e=this.s;e!==void 0;e=e.n)e.S.S(e)}Bt.prototype.S.call(this,n)},lr.prototype.U=function(n){if(this.t!==void 0&&(Bt.prototype.U.call(this,n),this.t===void 0)){this.f&=-33;for(var e=this.s;e!==void 0;e=e.n)e.S.U(e)}},lr.prototype.N=function(){if(!(2&this.f)){this.f|=6;for(var n=this.t;n!==void 0;n=n.x)n.t.N()}},Object.defineProperty(lr.prototype,"value",{get:function(){if(1&this.f)throw new Error("Cycle detected");var n=Nf(this);if(this.h(),n!==void 0&&(n.i=this.i),16&this.f)throw this.v;return this.v}});function Wt(n,e){return new lr(n,e)}function Bf(n){var e=n.j;if(n.j=void 0,typeof e=="function"){ci++;var t=ut;ut=void 0;try{e()}catch(i){throw n.f&=-2,n.f|=8,Tl(n),i}finally{ut=t,Ea()}}}function Tl(n){for(var e=n.s;e!==void 0;e=e.n)e.S.U(e);n.x=void 0,n.s=void 0,Bf(n)}function Pm(n){if(ut!==this)throw new Error("Out-of-order effect");Of(this),ut=n,this.f&=-2;try{8&this.f&&Tl(this)}finally{Ea()}}function Ur(n,e){this.x=n,this.j=void 0,this.s=void 0,this.u=void 0,this.f=32,this.name=e?.name,Ps&&Ps.push(this)}Ur.prototype.c=function(){var n=this.S();try{if(8&this.f||this.x===void 0)return;var e=this.x();typeof e=="function"&&(this.j=e)}finally{n()}},Ur.prototype.S=function(){if(1&this.f)throw new Error("Cycle detected");this.f|=1,this.f&=-9,Bf(this),Ff(this),ci++;var n=ut;return ut=this,Pm.bind(this,n)},Ur.prototype.N=function(){2&this.f||(this.f|=2,this.u=Ds,Ds=this)},Ur.prototype.d=function(){this.f|=8,1&this.f||Tl(this)},Ur.prototype.dispose=function(){this.d()};function Hn(n,e){var t=new Ur(n,e);try{t.c()}catch(r){throw t.d(),r}var i=t.d.bind(t);return i[Symbol.dispose]=i,i}var kf,Ra,Lm=typeof window<"u"&&!!window.__PREACT_SIGNALS_DEVTOOLS__,zf=[];Hn(function(){kf=this.N})();function Fr(n,e){et[n]=e.bind(null,et[n]||function(){})}function Is(n){if(Ra){var e=Ra;Ra=void 0,e()}Ra=n&&n.S()}function Hf(n){var e=this,t=n.data,i=Im(t);i.name="ReactiveDom",i.value=t;var r=yl(function(){for(var o=e,l=e.__v;l=l.__;)if(l.__c){l.__c.__$f|=4;break}var c=Wt(function(){var h=i.value.value;return h===0?0:h===!0?"":h||""}),f=Wt(function(){return!Array.isArray(c.value)&&!cf(c.value)}),d=Hn(function(){if(this.N=Gf,f.value){var h=c.value;o.__v&&o.__v.__e&&o.__v.__e.nodeType===3&&(o.__v.__e.data=h)}}),u=e.__$u.d;return e.__$u.d=function(){d(),u.call(this)},[f,c]},[]),s=r[0],a=r[1];return s.value?a.peek():a.value}Hf.displayName="ReactiveTextNode",Object.defineProperties(Bt.prototype,{constructor:{configurable:!0,value:pf(ht,null).constructor},type:{configurable:!0,value:Hf},props:{configurable:!0,get:function(){var n=this;return{data:{get value(){return n.value}}}}},__b:{configurable:!0,value:1}}),Fr("__b",function(n,e){if(Is(),typeof e.type=="string"){var t,i=e.props;for(var r in i)if(r!=="children"){var s=i[r];s instanceof Bt&&(t||(e.__np=t={}),t[r]=s,i[r]=s.peek())}}n(e)}),Fr("__r",function(n,e){if(n(e),e.type!==ht){Is();var t,i=e.__c;i&&(i.__$f&=-2,(t=i.__$u)===void 0&&(i.__$u=t=(function(r,s){var a;return Hn(function(){a=this},{name:s}),a.c=r,a})((function(r){return function(){var s;Lm&&((s=this.y)==null||s.call(this)),r.__$f|=1,r.setState({})}})(i),typeof e.type=="function"?e.type.displayName||e.type.name:""))),Is(t)}}),Fr("__e",function(n,e,t,i){Is(),n(e,t,i)}),Fr("diffed",function(n,e){Is();var t;if(typeof e.type=="string"&&(t=e.__e)){var i=e.__np,r=e.props,s=t.U;if(s)for(var a in s){var o=s[a];o===void 0||i&&a in i||(o.d(),s[a]=void 0)}if(i){s||(s={},t.U=s);for(var l in i){var c=s[l],f=i[l];c===void 0?(c=Dm(t,l,f,r),s[l]=c):c.o(f,r)}}}n(e)});function Dm(n,e,t,i){var r=e in n&&n.ownerSVGElement===void 0,s=Ve(t);return{o:function(a,o){s.value=a,i=o},d:Hn(function(){this.N=Gf;var a=s.value.value;i[e]!==a&&(i[e]=a,r?n[e]=a:a!=null&&(a!==!1||e[4]==="-")?n.setAttribute(e,a):n.removeAttribute(e))})}}Fr("unmount",function(n,e){if(typeof e.type=="string"){var t=e.__e;if(t){var i=t.U;if(i){t.U=void 0;for(var r in i){var s=i[r];s&&s.d()}}}var a=e.__np;if(a){var o=e.props;for(var l in a)o[l]=a[l]}e.__np=void 0}else{var c=e.__c;if(c){c.__$f|=8;var f=c.__$u;f&&(c.__$u=void 0,f.d())}}n(e)}),Fr("__h",function(n,e,t,i){i<3&&(e.__$f|=2),n(e,t,i)}),As.prototype.shouldComponentUpdate=function(n,e){if(this.__R)return!0;var t=this.__$u,i=t&&t.s!==void 0;for(var r in e)return!0;if(this.__f||typeof this.u=="boolean"&&this.u===!0){var s=2&this.__$f;if(!(i||s||4&this.__$f)||1&this.__$f)return!0}else if(!(i||4&this.__$f)||3&this.__$f)return!0;for(var a in n)if(a!=="__source"&&n[a]!==this.props[a])return!0;for(var o in this.props)if(!(o in n))return!0;return!1};function Im(n,e){return yl(function(){return Ve(n,e)},[])}var Nm=function(n){queueMicrotask(function(){queueMicrotask(n)})};function Um(){Cs(function(){for(var n;n=zf.shift();)kf.call(n)})}function Gf(){zf.push(this)===1&&(et.requestAnimationFrame||Nm)(Um)}const Fm=["not damage","wrong place","duplicate","other"],Om=["serviceable","monitor","reject"],Al={state:"open",reason:null,label:null,blade:null,severity:null,point:null,merged_into:null,notes:[],measures:[],without:[],by:null,time:null},Bm=1e-6;function Vf(n){return{kind:"defect",id:n.id,label:km(n.label),model:n.model,centroid:n.centroid,sigma:n.centroid_sigma??null}}const km=n=>n.replace(/[\0-\x08\x0b-\x1f\x7f]/g,"").slice(0,1e3);function Wf(n,e){const t=Xf(n),i=new Map;for(const c of t)(c.action==="add"||c.action==="split")&&i.set(c.id,`H${i.size+1}`);const r=new Map(e.map(c=>[`D${c.id}`,{name:`D${c.id}`,target:c,review:Al,made:null}])),s=new Map,a=c=>{if(c.kind==="added")return i.get(c.id)??`H-${c.id}`;const f=e.filter(u=>Gm(u,c));return f.sort((u,h)=>+(u.id!==c.id)-+(h.id!==c.id)||Rl(u,c)-Rl(h,c)),f[0]?`D${f[0].id}`:[...s.values()].find(u=>qf(u.target,c))?.name??`U${1+[...s.values()].filter(u=>u.target.kind==="defect").length}`},o=(c,f)=>{const d=i.get(c.id);r.set(d,{name:d,target:f,review:{...Al,by:c.by||null,time:c.time},made:c})},l=(c,f)=>{const d=a(f);for(let u=d;u;u=r.get(u)?.review.merged_into??null)if(u===c.name)return c.review;return{...c.review,state:"merged",reason:null,merged_into:d}};for(const c of $f(t)){if(c.action==="add"){const g=c.value;o(c,{kind:"added",id:c.id,label:g.label,model:c.target.model,centroid:g.point,sigma:null});continue}const f=a(c.target),d=r.has(f)?r:s,u=d.get(f)??{name:f,target:c.target,review:Al,made:null},h=c.action==="merge"?l(u,c.value):zm(u.review,c);d.set(f,{...u,review:{...h,by:c.by||null,time:c.time}}),c.action==="split"&&o(c,{...u.target,kind:"added",id:c.id,centroid:null,sigma:null})}return{findings:r,unattached:[...s.values()]}}function zm(n,{action:e,value:t,reason:i,by:r,time:s}){switch(e){case"accept":return{...n,state:"accepted",reason:null,merged_into:null};case"reject":return{...n,state:"rejected",reason:i,merged_into:null};case"relabel":return{...n,label:String(t)};case"set_blade":return{...n,blade:String(t)};case"severity":return{...n,severity:String(t)};case"note":return{...n,notes:[...n.notes,{text:String(t),by:r??"",time:s}]};case"move":return{...n,point:t.point};case"measure":return{...n,measures:[...n.measures,t]};case"split":return{...n,without:[...new Set([...n.without,...t.detections])].sort((a,o)=>a-o)};default:return n}}function Hm(n,e){return $f(Xf(n)).filter(t=>e==null||!t.by||t.by===e).pop()??null}function $f(n){const e=new Set(n.filter(t=>t.action==="undo").map(t=>t.value));return n.filter(t=>t.action!=="undo"&&!e.has(t.id))}const Xf=n=>[...n].sort((e,t)=>e.revision-t.revision);function qf(n,e){return n.kind===e.kind&&n.id===e.id&&n.label===e.label&&n.model===e.model&&String(n.centroid)===String(e.centroid)&&(n.sigma??null)===(e.sigma??null)}function Gm(n,e){if(n.label!==e.label)return!1;const t=Math.max(1,...(e.centroid??[]).map(Math.abs));return Rl(n,e)<=Math.hypot(n.sigma??0,e.sigma??0)+Bm*t}function Rl(n,e){return!n.centroid||!e.centroid||n.model!==e.model?1/0:Math.hypot(...n.centroid.map((t,i)=>t-e.centroid[i]))}function Vm(n){if(!n)return null;try{const e=JSON.parse(n);return!Array.isArray(e)||!e.every(t=>typeof t=="object"&&t!==null&&"revision"in t&&"action"in t&&"target"in t)?null:Wm(e)}catch{return null}}function Wm(n){const e=new Map(n.map(t=>[t.revision,t.id??`v1-${t.revision}-${t.time}`]));return n.map(t=>({...t,id:t.id??e.get(t.revision),value:t.id===void 0&&t.action==="undo"?e.get(t.value)??"none":t.value}))}function Cl(){return Array.from(crypto.getRandomValues(new Uint8Array(16)),n=>n.toString(16).padStart(2,"0")).join("")}const wt=n=>n<0?`H${-n}`:`D${n}`;function _n(n){return`${n.toFixed(2)} s`}const Yf=25.4;function vn(n,e,t,i="mm"){if(n==null)return"unknown";if(i==="in"&&(t==="mm"||t==="mm²")){const a=t==="mm"?Yf:Yf**2;return vn(n/a,e==null?e:e/a,t.replace("mm","in"))}const r=t==="model"?"":` ${t}`;if(!e)return`${$m(n,3)}${r}`;const s=Math.max(0,1-Math.floor(Math.log10(e)));return`${n.toFixed(Math.min(s,9))} ± ${e.toFixed(Math.min(s,9))}${r}`}function Kf(n,e,t){return t.unit==="model"||!t.scale?{value:n,sigma:e,unit:"model"}:{value:t.scale*n,sigma:Math.hypot(t.scale*e,(t.scale_sigma??0)*n),unit:t.unit}}function $m(n,e){return String(Number(n.toPrecision(e)))}function cr(n){return`${Math.round(100*n)} %`}function Pl(n){return n>=.75?"high":n>=.4?"medium":"low"}function Xm(n){const e=n.confidence?.parts??{},t=u=>e[u]??null,i=[],[r,s,a]=[t("views_visible"),t("views_support"),t("views_same_label")];if(r!==null&&s!==null){const u=r>0?s/r:0,h=r>0?`${Or(s)} of ${Or(r)} other views of the place show a box there`:"no other view could see the place";i.push([r>0?u:0,`${h}.`]),s>0&&a!==null&&i.push([a/s,`${Or(a)} of these ${Or(s)} give it the same label.`])}const o=t("peers");o!==null&&i.push([o>0?.9:.2,o>0?`${Or(o)} further observations lie at the same place.`:"It was observed once only."]);const l=t("cosine");l!==null&&i.push([l,`It is seen at ${Math.round(Math.acos(Math.min(1,l))*180/Math.PI)}° from straight on.`]);const c=t("depth_agreement");c!==null&&i.push([c,`${cr(c)} of the depth map under the box agree with the surface.`]);const f=t("cloud_spacings");f!==null&&f>2&&i.push([.1,`The surface there is ${f.toFixed(1)} point spacings away from measured points.`]);const d=t("model_doubts");return d&&i.push([0,`The checks raise ${d===1?"a warning":`${Or(d)} warnings`} about the whole model.`]),i.sort((u,h)=>u[0]-h[0]).map(([,u])=>u)}function Or(n){return String(Math.round(n*10)/10)}function ur(n,e){return e?n.reasons?.[e]??qm[e]??e.replaceAll("_"," "):""}const qm={frame_not_registered:"the camera of this frame could not be found",not_registered:"the camera of this frame could not be found",outside_roi:"this pixel lies outside the part of the picture that was used",off_surface:"the reconstructed surface does not reach here",occluded:"the surface is seen from behind here: it lies in another blade's shadow or is no real front",no_surface:"the result has no surface"};function Ll(n){return n==null||n===""||n===0?"unknown":String(n)}const fr=/^(.*\/v1\/inspections\/([0-9a-f]{32}))\/(?:models\/\d+\/)?viewer\//.exec(location.protocol.startsWith("http")?location.pathname:""),Ca=fr?`${fr[1]}/reviews`:null,Zf=`bladeatlas unsent ${fr?.[2]??""}`,Jf=1e4,Ni=Ca!==null,Ym=fr?fr[1].replace(/\/v1\/inspections\/.*/,"/"):"",Km=fr?`${fr[1]}/report.pdf`:"",dr=Ve([]),ui=Ve(Ni?ng():[]),Qf=Ve(Om),Ns=Ve(null),Br=Ve(!0),jt=Ve(null),Us=Ve(""),Zm=Wt(()=>[...dr.value,...ui.value.map((n,e)=>({...n,revision:Fs()+1+e,by:Ns.value??""}))]);let Dl=!1,jf=0;function Fs(){return dr.value[dr.value.length-1]?.revision??0}function Jm(n){Il([...ui.peek(),n]),kr()}function Qm(){jt.value=null,kr(!0)}function jm(){jt.value=null,Il(ui.peek().slice(1)),kr()}function eg(){Ca&&(Pa().then(()=>kr()),window.setInterval(()=>{document.visibilityState==="visible"&&jt.peek()?.kind!=="conflict"&&Pa().then(()=>kr())},Jf))}async function kr(n=!1){if(!(!Ca||Dl||jt.peek()?.kind==="conflict"||jt.peek()?.kind==="refused")){Dl=!0,clearTimeout(jf);try{for(let e=ui.peek()[0];e;e=ui.peek()[0])if(!await tg(e,n))return}finally{Dl=!1}}}async function tg(n,e){const{id:t,target:i,action:r,value:s,reason:a}=n,o=await ed("POST","",{id:t,target:i,action:r,value:s,reason:a,revision:Fs()});if(!o)return!1;if(o.ok){const c=await o.json();return c.revision===Fs()+1?dr.value=[...dr.peek(),c]:await Pa(),Ns.value=c.by??Ns.peek(),Il(ui.peek().filter(f=>f.id!==t)),jt.value=null,!0}if(o.status===409){const c=(await Pa()).filter(d=>d.id!==t),f=c.filter(d=>qf(d.target,i));return c.length&&(Us.value=`${c.length} ${c.length===1?"record":"records"} of others came meanwhile; nothing is lost.`),!f.length||e?jt.peek()===null:(jt.value={kind:"conflict",text:"Somebody else has spoken of this finding meanwhile (409).",others:f},!1)}const l=await o.json().catch(()=>({}));return jt.value={kind:"refused",text:l.detail??`the service answers ${o.status}`,others:[]},!1}async function Pa(){const n=await ed("GET",`?since=${Fs()}`);if(!n?.ok)return[];const e=await n.json(),t=e.records.filter(i=>i.revision>Fs());return t.length&&(dr.value=[...dr.peek(),...t]),Qf.value=e.severities,Br.value=e.may_review,Ns.value=e.you,(jt.peek()?.kind==="offline"||jt.peek()?.kind==="sign-in")&&(jt.value=null),t}async function ed(n,e,t){try{const i=await fetch(Ca+e,{method:n,credentials:"same-origin",headers:t?{"Content-Type":"application/json","X-BladeAtlas-Write":"1"}:{},...t?{body:JSON.stringify(t)}:{}});if(i.status===401){jt.value={kind:"sign-in",text:"The session is over: sign in on the start page. What was not sent waits in this browser.",others:[]};return}if(i.status>=500||i.status===429)throw new Error(String(i.status));return i}catch{jt.value={kind:"offline",text:"The service does not answer. What was not sent waits in this browser and is sent as soon as it does.",others:[]},jf=window.setTimeout(()=>{kr()},Jf/2);return}}function Il(n){ui.value=n;try{localStorage.setItem(Zf,JSON.stringify(n))}catch{Us.value="This browser keeps nothing: leave the page open until all is sent."}}function ng(){try{return JSON.parse(localStorage.getItem(Zf)??"[]")}catch{return[]}}const Nl=1;function ig(n){const e=atob(n),t=new Uint8Array(e.length);for(let i=0;i<e.length;i++)t[i]=e.charCodeAt(i);return t}const rg={SCALAR:1,VEC2:2,VEC3:3,VEC4:4},sg={5120:127,5121:255,5122:32767,5123:65535,5125:4294967295,5126:1},ag={5120:1,5121:1,5122:2,5123:2,5125:4,5126:4},og=1313821514;function lg(n){const e=new DataView(n.buffer,n.byteOffset,n.byteLength);if(e.getUint32(0,!0)!==1179937895||e.getUint32(4,!0)!==2||e.getUint32(16,!0)!==og)throw new Error("surface.glb is no binary glTF 2.0");const t=e.getUint32(12,!0),i=JSON.parse(new TextDecoder().decode(n.subarray(20,20+t))),r=20+t+8,s=i.nodes.flatMap(d=>(d.mesh===void 0?[]:i.meshes[d.mesh]?.primitives??[]).map(h=>({node:d,primitive:h}))),a=d=>s.reduce((u,{primitive:h})=>u+(i.accessors[(d?h.attributes[d]:h.indices)??-1]?.count??0),0),o=a("POSITION"),l={position:new Float32Array(3*o),normal:new Float32Array(3*o),color:new Uint8Array(4*o).fill(160),support:new Uint8Array(o).fill(255),blade:new Uint8Array(o),finding:new Int32Array(o).fill(-1),index:new Uint32Array(a(null))};let[c,f]=[0,0];for(const{node:d,primitive:u}of s){const h=A=>{const _=u.attributes[A];return _===void 0?null:td(i,e,r,_)},g=h("POSITION")??new Float32Array(0),x=fg(d),m=g.length/3;for(let A=0;A<m;A++)for(let _=0;_<3;_++){let b=x[12+_];for(let I=0;I<3;I++)b+=x[4*I+_]*g[3*A+I];l.position[3*(c+A)+_]=b}const p=h("NORMAL");p&&l.normal.set(p,3*c);const v=h("COLOR_0");v&&cg(v,v.length/m,l.color,4*c);const y=h("_SUPPORT");y&&l.support.set(y.map(A=>Math.round(255*A)),c);const S=h("_BLADE");S&&l.blade.set(S,c);const E=/^defect_(\d+)$/.exec(d.name??"");if(E&&l.finding.fill(Number(E[1]),c,c+m),u.indices!==void 0){const A=td(i,e,r,u.indices,!0);for(let _=0;_<A.length;_++)l.index[f+_]=A[_]+c;f+=A.length}c+=m}return l}function cg(n,e,t,i){for(let r=0;r<n.length/e;r++){for(let s=0;s<3;s++)t[i+4*r+s]=Math.round(255*n[e*r+s]);t[i+4*r+3]=255}}function td(n,e,t,i,r=!1){const s=n.accessors[i],a=rg[s.type]??1,o=r?new Float64Array(a*s.count):new Float32Array(a*s.count),l=s.bufferView===void 0?void 0:n.bufferViews[s.bufferView];if(!l)return o;const c=ag[s.componentType],f=l.byteStride??a*c,d=t+(l.byteOffset??0)+(s.byteOffset??0),u=s.normalized?1/sg[s.componentType]:1,h=ug(e,s.componentType);for(let g=0;g<s.count;g++)for(let x=0;x<a;x++)o[a*g+x]=h(d+g*f+x*c)*u;return o}function ug(n,e){switch(e){case 5120:return t=>n.getInt8(t);case 5121:return t=>n.getUint8(t);case 5122:return t=>n.getInt16(t,!0);case 5123:return t=>n.getUint16(t,!0);case 5125:return t=>n.getUint32(t,!0);case 5126:return t=>n.getFloat32(t,!0);default:throw new Error(`surface.glb has components of the unknown kind ${e}`)}}function fg(n){if(n.matrix)return n.matrix;const[e=0,t=0,i=0]=n.translation??[],[r=0,s=0,a=0,o=1]=n.rotation??[],[l=1,c=1,f=1]=n.scale??[];return[(1-2*(s*s+a*a))*l,2*(r*s+a*o)*l,2*(r*a-s*o)*l,0,2*(r*s-a*o)*c,(1-2*(r*r+a*a))*c,2*(s*a+r*o)*c,0,2*(r*a+s*o)*f,2*(s*a-r*o)*f,(1-2*(r*r+s*s))*f,0,e,t,i,1]}const dg={SIMPLE_PINHOLE:["f","cx","cy"],PINHOLE:["fx","fy","cx","cy"],SIMPLE_RADIAL:["f","cx","cy","k1"],RADIAL:["f","cx","cy","k1","k2"],OPENCV:["fx","fy","cx","cy","k1","k2","p1","p2"],SIMPLE_FISHEYE:["f","cx","cy"],SIMPLE_RADIAL_FISHEYE:["f","cx","cy","k1"],RADIAL_FISHEYE:["f","cx","cy","k1","k2"],OPENCV_FISHEYE:["fx","fy","cx","cy","k1","k2","k3","k4"]};function hg(n,e){const t=dg[n];if(!t||t.length!==e.length)return null;const i=s=>e[t.indexOf(s)]??0,r=i("f");return{fx:i("fx")||r,fy:i("fy")||r,cx:i("cx"),cy:i("cy"),radial:[i("k1"),i("k2"),i("k3"),i("k4")],tangential:[i("p1"),i("p2")],fisheye:n.endsWith("FISHEYE")}}function nd(n){const[e,t,i,r]=n.radial,s=n.fisheye?Math.PI:20;for(let a=0;a<=s;a+=s/4e3){const o=a*a;if(1+o*(3*e+o*(5*t+o*(7*i+o*9*r)))<=0)return a}return 1/0}function pg(n,e,t,i,r=nd(n)){const[s,a,o,l]=n.radial,c=Math.hypot(e,t);if(i<=0)return null;if(n.fisheye){const m=Math.atan2(c,i);if(m>=r)return null;const p=m*m,v=m*(1+p*(s+p*(a+p*(o+p*l)))),y=c>1e-12?v/c:1/i;return[n.fx*e*y+n.cx,n.fy*t*y+n.cy]}const[f,d]=[e/i,t/i],u=f*f+d*d;if(Math.sqrt(u)>=r)return null;const[h,g]=n.tangential,x=1+u*(s+u*a);return[n.fx*(f*x+2*h*f*d+g*(u+2*f*f))+n.cx,n.fy*(d*x+2*g*f*d+h*(u+2*d*d))+n.cy]}function Ul(n,e,t){const i=(e-n.cx)/n.fx,r=(t-n.cy)/n.fy;if(n.fisheye){const s=Math.hypot(i,r),a=mg(n,s);if(a===null)return null;if(s<1e-12)return[0,0,1];const o=Math.sin(a)/s;return[i*o,r*o,Math.cos(a)]}return gg(n,i,r)}function mg(n,e){const[t,i,r,s]=n.radial;let a=Math.min(e,1.5);for(let o=0;o<50;o++){const l=a*a,c=a*(1+l*(t+l*(i+l*(r+l*s))))-e,f=1+l*(3*t+l*(5*i+l*(7*r+l*9*s)));if(f<=0)return null;if(a-=c/f,Math.abs(c)<1e-12)break}return a>=0&&a<Math.PI/2?a:null}function gg(n,e,t){const[i,r]=n.radial,[s,a]=n.tangential;let[o,l]=[e,t];for(let f=0;f<100;f++){const d=o*o+l*l,u=1+d*(i+d*r),[h,g]=[o,l];if(o=(e-2*s*o*l-a*(d+2*o*o))/u,l=(t-2*a*h*l-s*(d+2*l*l))/u,Math.abs(o-h)+Math.abs(l-g)<1e-13)break}const c=Math.hypot(o,l,1);return[o/c,l/c,1/c]}const La=[[255,176,0],[86,180,233],[240,90,160],[0,200,150],[190,130,255],[240,228,66],[255,110,60],[160,220,90]],id=["M1 0A1 1 0 1 1-1 0A1 1 0 1 1 1 0Z","M-.85-.85H.85V.85H-.85Z","M0-1L1 .85H-1Z","M0-1.1L1.1 0L0 1.1L-1.1 0Z","M-.35-1H.35V-.35H1V.35H.35V1H-.35V.35H-1V-.35H-.35Z","M0 1L-1-.85H1Z","M-.5-.9H.5L1 0L.5 .9H-.5L-1 0Z","M0-1.1L.3-.35L1.1-.3L.5 .2L.7 1L0 .55L-.7 1L-.5 .2L-1.1-.3L-.3-.35Z"];function _g(n){const e=[...new Set(n)].sort();return new Map(e.map((t,i)=>[t,vg(i)]))}function vg(n){const e=n%La.length;return{index:e,css:`rgb(${(La[e]??[128,128,128]).join(" ")})`,shape:id[(n+Math.floor(n/La.length))%id.length]}}function rd(n){const e=n.cam_from_world;if(!e||e.length!==12)return null;const t=r=>e[r],i=r=>-(t(r)*t(3)+t(4+r)*t(7)+t(8+r)*t(11));return{frame:n.index,m:e,center:[i(0),i(1),i(2)]}}function xg(n,e){const t=i=>n.m[i]*e[0]+n.m[i+1]*e[1]+n.m[i+2]*e[2]+n.m[i+3];return[t(0),t(4),t(8)]}function zr(n,e){const t=i=>n.m[i]*e[0]+n.m[4+i]*e[1]+n.m[8+i]*e[2];return[t(0),t(1),t(2)]}const fi=(n,e)=>[n[0]-e[0],n[1]-e[1],n[2]-e[2]],Fl=(n,e)=>n[0]*e[0]+n[1]*e[1]+n[2]*e[2],di=n=>Math.hypot(n[0],n[1],n[2]);function Sg(n,e){const[t,i]=[sd(n.axis),sd(n.point)],r=n.root;if(n.status==="unknown"||!t||!i||r!=="inside"&&r!=="outside"&&r!=="inner"&&r!=="outer")return null;const s=fi(e,i),a=Fl(s,t)/Fl(t,t),o=[s[0]-a*t[0],s[1]-a*t[1],s[2]-a*t[2]],l=di(o);if(!(l>0))return null;const c=(r.startsWith("in")?1:-1)/l;return{tip:[c*o[0],c*o[1],c*o[2]]}}function Mg(n){const e=n.coverage;return Array.isArray(e)?e.flatMap(t=>t&&typeof t.blade=="number"&&typeof t.views_2=="number"?[{number:t.blade,name:String(t.name??t.blade),seen:t.views_2}]:[]):[]}function sd(n){return Array.isArray(n)&&n.length===3&&n.every(e=>typeof e=="number")?n:null}const Da=4,yg=75,bg=5;class Eg{constructor(e,t,i,r,s){this.lens=e,this.crop=t,this.surface=r,this.spacing=s,this.poses=new Map(i.flatMap(a=>rd(a)?[[a.index,rd(a)]]:[])),this.fold=e?nd(e):0}lens;crop;surface;spacing;poses;fold;pointAt(e,t,i){const r=this.poses.get(e);if(!r||!this.lens)return{reason:"frame_not_registered"};const[s,a,o,l]=this.crop;if(!(t>=s&&t<=o&&i>=a&&i<=l))return{reason:"outside_roi"};if(!this.surface)return{reason:"no_surface"};const c=Ul(this.lens,t,i),f=c&&this.surface.cast(r.center,zr(r,c));if(!f)return{reason:"off_surface"};if(f.cosine<=0)return{reason:"occluded"};const d=Math.acos(Math.min(1,f.cosine))*180/Math.PI,{point:u,normal:h,distance:g,finding:x,support:m}=f;return{reason:null,point:u,normal:h,distance:g,incidence_deg:d,finding:x,support:m}}visibleFrames(e,t){const i=Math.cos(yg*Math.PI/180),r=[];for(const a of this.poses.values()){const o=this.pixelOf(a.frame,e),[l,c,f,d]=this.crop;if(!o||!(o[0]>l+Da&&o[0]<f-Da&&o[1]>c+Da&&o[1]<d-Da))continue;const u=fi(a.center,e),h=di(u),g=Fl(u,t)/h;g<=i||!this.surface?.clear(a.center,e,bg*this.spacing)||r.push({frame:a.frame,quality:g/h**2,x:o[0],y:o[1]})}const s=Math.max(...r.map(a=>a.quality),1e-300);return r.map(a=>({...a,quality:a.quality/s})).sort((a,o)=>o.quality-a.quality||a.frame-o.frame)}pixelOf(e,t){const i=this.poses.get(e);return i&&this.lens?pg(this.lens,...xg(i,t),this.fold):null}get limit(){return this.fold}}const Os="187",wg=0,ad=1,Tg=2,Ia=1,Ag=2,Bs=3,hi=0,en=1,un=2,Hr=0,ks=1,od=2,ld=3,cd=4,Rg=5,Gr=100,Cg=101,Pg=102,Lg=103,Dg=104,Ig=200,Ng=201,Ug=202,Fg=203,ud=204,fd=205,Og=206,Bg=207,kg=208,zg=209,Hg=210,Gg=211,Vg=212,Wg=213,$g=214,Ol=0,Bl=1,kl=2,zs=3,zl=4,Hl=5,Gl=6,Vl=7,dd=0,Xg=1,qg=2,pi=0,hd=1,pd=2,md=3,gd=4,_d=5,vd=6,xd=7,Sd=300,Vr=301,Hs=302,Wl=303,$l=304,Xl=1e3,mi=1001,ql=1002,kt=1003,Yg=1004,Na=1005,on=1006,Yl=1007,Ui=1008,xn=1009,Md=1010,yd=1011,Gs=1012,Kl=1013,Gn=1014,Vn=1015,Wn=1016,Zl=1017,Jl=1018,Wr=1020,bd=35902,Ed=35899,wd=1021,Td=1022,$n=1023,Fi=1026,Oi=1027,Ad=1028,Ql=1029,hr=1030,jl=1031,ec=1033,Ua=33776,Fa=33777,Oa=33778,Ba=33779,tc=35840,nc=35841,ic=35842,rc=35843,sc=36196,ac=37492,oc=37496,lc=37488,cc=37489,ka=37490,uc=37491,fc=37808,dc=37809,hc=37810,pc=37811,mc=37812,gc=37813,_c=37814,vc=37815,xc=37816,Sc=37817,Mc=37818,yc=37819,bc=37820,Ec=37821,wc=36492,Tc=36494,Ac=36495,Rc=36283,Cc=36284,za=36285,Pc=36286,Kg=3200,Rd=0,Zg=1,Bi="",Sn="srgb",Ha="srgb-linear",Ga="linear",nt="srgb",Lc=7680,Jg=519,Qg=512,jg=513,e_=514,Cd=515,t_=516,n_=517,Pd=518,Ld=519,i_=35044,Dc="300 es",Ln=2e3,Va=2001;function r_(n){for(let e=n.length-1;e>=0;--e)if(n[e]>=65535)return!0;return!1}function Wa(n){return document.createElementNS("http://www.w3.org/1999/xhtml",n)}function s_(){const n=Wa("canvas");return n.style.display="block",n}const Dd={};function Id(...n){const e="THREE."+n.shift();console.log(e,...n)}function Nd(n){const e=n[0];if(typeof e=="string"&&e.startsWith("TSL:")){const t=n[1];t&&t.isStackTrace?n[0]+=" "+t.getLocation():n[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return n}function Le(...n){n=Nd(n);const e="THREE."+n.shift();{const t=n[0];t&&t.isStackTrace?console.warn(t.getError(e)):console.warn(e,...n)}}function Qe(...n){n=Nd(n);const e="THREE."+n.shift();{const t=n[0];t&&t.isStackTrace?console.error(t.getError(e)):console.error(e,...n)}}function $a(...n){const e=n.join(" ");e in Dd||(Dd[e]=!0,Le(...n))}function a_(n,e,t){return new Promise(function(i,r){function s(){switch(n.clientWaitSync(e,n.SYNC_FLUSH_COMMANDS_BIT,0)){case n.WAIT_FAILED:r();break;case n.TIMEOUT_EXPIRED:setTimeout(s,t);break;default:i()}}setTimeout(s,t)})}const o_={[Ol]:Ol,[kl]:Gl,[zl]:zl,[zs]:Hl,[Bl]:Bl,[Gl]:kl,[Vl]:Vl,[Hl]:zs};class pr{addEventListener(e,t){this._listeners===void 0&&(this._listeners={});const i=this._listeners;i[e]===void 0&&(i[e]=[]),i[e].indexOf(t)===-1&&i[e].push(t)}hasEventListener(e,t){const i=this._listeners;return i===void 0?!1:i[e]!==void 0&&i[e].indexOf(t)!==-1}removeEventListener(e,t){const i=this._listeners;if(i===void 0)return;const r=i[e];if(r!==void 0){const s=r.indexOf(t);s!==-1&&r.splice(s,1)}}dispatchEvent(e){const t=this._listeners;if(t===void 0)return;const i=t[e.type];if(i!==void 0){e.target=this;const r=i.slice(0);for(let s=0,a=r.length;s<a;s++)r[s].call(this,e);e.target=null}}}const $t=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],Ic=Math.PI/180,Nc=180/Math.PI;function Vs(){const n=Math.random()*4294967295|0,e=Math.random()*4294967295|0,t=Math.random()*4294967295|0,i=Math.random()*4294967295|0;return($t[n&255]+$t[n>>8&255]+$t[n>>16&255]+$t[n>>24&255]+"-"+$t[e&255]+$t[e>>8&255]+"-"+$t[e>>16&15|64]+$t[e>>24&255]+"-"+$t[t&63|128]+$t[t>>8&255]+"-"+$t[t>>16&255]+$t[t>>24&255]+$t[i&255]+$t[i>>8&255]+$t[i>>16&255]+$t[i>>24&255]).toLowerCase()}function Oe(n,e,t){return Math.max(e,Math.min(t,n))}function l_(n,e){return(n%e+e)%e}function Uc(n,e,t){return(1-t)*n+t*e}function c_(n){return Math.pow(2,Math.floor(Math.log(n)/Math.LN2))}function Fc(n){switch(n.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function u_(n,e){if(e.constructor===Float32Array)return n;const t=Fc(e);if(t===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.max(n/t,-1)}function f_(n,e){if(e.constructor===Float32Array)return n;const t=Fc(e);if(t===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.round(n*t)}class We{static{this.prototype.isVector2=!0}constructor(e=0,t=0){this.x=e,this.y=t}get width(){return this.x}set width(e){this.x=e}get height(){return this.y}set height(e){this.y=e}set(e,t){return this.x=e,this.y=t,this}setScalar(e){return this.x=e,this.y=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;default:throw new Error("THREE.Vector2: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y)}copy(e){return this.x=e.x,this.y=e.y,this}add(e){return this.x+=e.x,this.y+=e.y,this}addScalar(e){return this.x+=e,this.y+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this}subScalar(e){return this.x-=e,this.y-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this}multiply(e){return this.x*=e.x,this.y*=e.y,this}multiplyScalar(e){return this.x*=e,this.y*=e,this}divide(e){return this.x/=e.x,this.y/=e.y,this}divideScalar(e){return this.multiplyScalar(1/e)}applyMatrix3(e){const t=this.x,i=this.y,r=e.elements;return this.x=r[0]*t+r[3]*i+r[6],this.y=r[1]*t+r[4]*i+r[7],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this}clamp(e,t){return this.x=Oe(this.x,e.x,t.x),this.y=Oe(this.y,e.y,t.y),this}clampScalar(e,t){return this.x=Oe(this.x,e,t),this.y=Oe(this.y,e,t),this}clampLength(e,t){const i=this.length();return this.divideScalar(i||1).multiplyScalar(Oe(i,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(e){return this.x*e.x+this.y*e.y}cross(e){return this.x*e.y-this.y*e.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(e){const t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;const i=this.dot(e)/t;return Math.acos(Oe(i,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){const t=this.x-e.x,i=this.y-e.y;return t*t+i*i}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this}lerpVectors(e,t,i){return this.x=e.x+(t.x-e.x)*i,this.y=e.y+(t.y-e.y)*i,this}equals(e){return e.x===this.x&&e.y===this.y}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this}rotateAround(e,t){const i=Math.cos(t),r=Math.sin(t),s=this.x-e.x,a=this.y-e.y;return this.x=s*i-a*r+e.x,this.y=s*r+a*i+e.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}}class ki{constructor(e=0,t=0,i=0,r=1){this.isQuaternion=!0,this._x=e,this._y=t,this._z=i,this._w=r}static slerpFlat(e,t,i,r,s,a,o){let l=i[r+0],c=i[r+1],f=i[r+2],d=i[r+3],u=s[a+0],h=s[a+1],g=s[a+2],x=s[a+3];if(d!==x||l!==u||c!==h||f!==g){let m=l*u+c*h+f*g+d*x;m<0&&(u=-u,h=-h,g=-g,x=-x,m=-m);let p=1-o;if(m<.9995){const v=Math.acos(m),y=Math.sin(v);p=Math.sin(p*v)/y,o=Math.sin(o*v)/y,l=l*p+u*o,c=c*p+h*o,f=f*p+g*o,d=d*p+x*o}else{l=l*p+u*o,c=c*p+h*o,f=f*p+g*o,d=d*p+x*o;const v=1/Math.sqrt(l*l+c*c+f*f+d*d);l*=v,c*=v,f*=v,d*=v}}e[t]=l,e[t+1]=c,e[t+2]=f,e[t+3]=d}static multiplyQuaternionsFlat(e,t,i,r,s,a){const o=i[r],l=i[r+1],c=i[r+2],f=i[r+3],d=s[a],u=s[a+1],h=s[a+2],g=s[a+3];return e[t]=o*g+f*d+l*h-c*u,e[t+1]=l*g+f*u+c*d-o*h,e[t+2]=c*g+f*h+o*u-l*d,e[t+3]=f*g-o*d-l*u-c*h,e}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get w(){return this._w}set w(e){this._w=e,this._onChangeCallback()}set(e,t,i,r){return this._x=e,this._y=t,this._z=i,this._w=r,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(e){return this._x=e.x,this._y=e.y,this._z=e.z,this._w=e.w,this._onChangeCallback(),this}setFromEuler(e,t=!0){const i=e._x,r=e._y,s=e._z,a=e._order,o=Math.cos,l=Math.sin,c=o(i/2),f=o(r/2),d=o(s/2),u=l(i/2),h=l(r/2),g=l(s/2);switch(a){case"XYZ":this._x=u*f*d+c*h*g,this._y=c*h*d-u*f*g,this._z=c*f*g+u*h*d,this._w=c*f*d-u*h*g;break;case"YXZ":this._x=u*f*d+c*h*g,this._y=c*h*d-u*f*g,this._z=c*f*g-u*h*d,this._w=c*f*d+u*h*g;break;case"ZXY":this._x=u*f*d-c*h*g,this._y=c*h*d+u*f*g,this._z=c*f*g+u*h*d,this._w=c*f*d-u*h*g;break;case"ZYX":this._x=u*f*d-c*h*g,this._y=c*h*d+u*f*g,this._z=c*f*g-u*h*d,this._w=c*f*d+u*h*g;break;case"YZX":this._x=u*f*d+c*h*g,this._y=c*h*d+u*f*g,this._z=c*f*g-u*h*d,this._w=c*f*d-u*h*g;break;case"XZY":this._x=u*f*d-c*h*g,this._y=c*h*d-u*f*g,this._z=c*f*g+u*h*d,this._w=c*f*d+u*h*g;break;default:Le("Quaternion: .setFromEuler() encountered an unknown order: "+a)}return t===!0&&this._onChangeCallback(),this}setFromAxisAngle(e,t){const i=t/2,r=Math.sin(i);return this._x=e.x*r,this._y=e.y*r,this._z=e.z*r,this._w=Math.cos(i),this._onChangeCallback(),this}setFromRotationMatrix(e){const t=e.elements,i=t[0],r=t[4],s=t[8],a=t[1],o=t[5],l=t[9],c=t[2],f=t[6],d=t[10],u=i+o+d;if(u>0){const h=.5/Math.sqrt(u+1);this._w=.25/h,this._x=(f-l)*h,this._y=(s-c)*h,this._z=(a-r)*h}else if(i>o&&i>d){const h=2*Math.sqrt(1+i-o-d);this._w=(f-l)/h,this._x=.25*h,this._y=(r+a)/h,this._z=(s+c)/h}else if(o>d){const h=2*Math.sqrt(1+o-i-d);this._w=(s-c)/h,this._x=(r+a)/h,this._y=.25*h,this._z=(l+f)/h}else{const h=2*Math.sqrt(1+d-i-o);this._w=(a-r)/h,this._x=(s+c)/h,this._y=(l+f)/h,this._z=.25*h}return this._onChangeCallback(),this}setFromUnitVectors(e,t){let i=e.dot(t)+1;return i<1e-8?(i=0,Math.abs(e.x)>Math.abs(e.z)?(this._x=-e.y,this._y=e.x,this._z=0,this._w=i):(this._x=0,this._y=-e.z,this._z=e.y,this._w=i)):(this._x=e.y*t.z-e.z*t.y,this._y=e.z*t.x-e.x*t.z,this._z=e.x*t.y-e.y*t.x,this._w=i),this.normalize()}angleTo(e){return 2*Math.acos(Math.abs(Oe(this.dot(e),-1,1)))}rotateTowards(e,t){const i=this.angleTo(e);if(i===0)return this;const r=Math.min(1,t/i);return this.slerp(e,r),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(e){return this._x*e._x+this._y*e._y+this._z*e._z+this._w*e._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let e=this.length();return e===0?(this._x=0,this._y=0,this._z=0,this._w=1):(e=1/e,this._x=this._x*e,this._y=this._y*e,this._z=this._z*e,this._w=this._w*e),this._onChangeCallback(),this}multiply(e){return this.multiplyQuaternions(this,e)}premultiply(e){return this.multiplyQuaternions(e,this)}multiplyQuaternions(e,t){const i=e._x,r=e._y,s=e._z,a=e._w,o=t._x,l=t._y,c=t._z,f=t._w;return this._x=i*f+a*o+r*c-s*l,this._y=r*f+a*l+s*o-i*c,this._z=s*f+a*c+i*l-r*o,this._w=a*f-i*o-r*l-s*c,this._onChangeCallback(),this}slerp(e,t){let i=e._x,r=e._y,s=e._z,a=e._w,o=this.dot(e);o<0&&(i=-i,r=-r,s=-s,a=-a,o=-o);let l=1-t;if(o<.9995){const c=Math.acos(o),f=Math.sin(c);l=Math.sin(l*c)/f,t=Math.sin(t*c)/f,this._x=this._x*l+i*t,this._y=this._y*l+r*t,this._z=this._z*l+s*t,this._w=this._w*l+a*t,this._onChangeCallback()}else this._x=this._x*l+i*t,this._y=this._y*l+r*t,this._z=this._z*l+s*t,this._w=this._w*l+a*t,this.normalize();return this}slerpQuaternions(e,t,i){return this.copy(e).slerp(t,i)}random(){const e=2*Math.PI*Math.random(),t=2*Math.PI*Math.random(),i=Math.random(),r=Math.sqrt(1-i),s=Math.sqrt(i);return this.set(r*Math.sin(e),r*Math.cos(e),s*Math.sin(t),s*Math.cos(t))}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._w===this._w}fromArray(e,t=0){return this._x=e[t],this._y=e[t+1],this._z=e[t+2],this._w=e[t+3],this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._w,e}fromBufferAttribute(e,t){return this._x=e.getX(t),this._y=e.getY(t),this._z=e.getZ(t),this._w=e.getW(t),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}}class N{static{this.prototype.isVector3=!0}constructor(e=0,t=0,i=0){this.x=e,this.y=t,this.z=i}set(e,t,i){return i===void 0&&(i=this.z),this.x=e,this.y=t,this.z=i,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;default:throw new Error("THREE.Vector3: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this}multiplyVectors(e,t){return this.x=e.x*t.x,this.y=e.y*t.y,this.z=e.z*t.z,this}applyEuler(e){return this.applyQuaternion(Ud.setFromEuler(e))}applyAxisAngle(e,t){return this.applyQuaternion(Ud.setFromAxisAngle(e,t))}applyMatrix3(e){const t=this.x,i=this.y,r=this.z,s=e.elements;return this.x=s[0]*t+s[3]*i+s[6]*r,this.y=s[1]*t+s[4]*i+s[7]*r,this.z=s[2]*t+s[5]*i+s[8]*r,this}applyNormalMatrix(e){return this.applyMatrix3(e).normalize()}applyMatrix4(e){const t=this.x,i=this.y,r=this.z,s=e.elements,a=1/(s[3]*t+s[7]*i+s[11]*r+s[15]);return this.x=(s[0]*t+s[4]*i+s[8]*r+s[12])*a,this.y=(s[1]*t+s[5]*i+s[9]*r+s[13])*a,this.z=(s[2]*t+s[6]*i+s[10]*r+s[14])*a,this}applyQuaternion(e){const t=this.x,i=this.y,r=this.z,s=e.x,a=e.y,o=e.z,l=e.w,c=2*(a*r-o*i),f=2*(o*t-s*r),d=2*(s*i-a*t);return this.x=t+l*c+a*d-o*f,this.y=i+l*f+o*c-s*d,this.z=r+l*d+s*f-a*c,this}project(e){return this.applyMatrix4(e.matrixWorldInverse).applyMatrix4(e.projectionMatrix)}unproject(e){return this.applyMatrix4(e.projectionMatrixInverse).applyMatrix4(e.matrixWorld)}transformDirection(e){const t=this.x,i=this.y,r=this.z,s=e.elements;return this.x=s[0]*t+s[4]*i+s[8]*r,this.y=s[1]*t+s[5]*i+s[9]*r,this.z=s[2]*t+s[6]*i+s[10]*r,this.normalize()}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this}divideScalar(e){return this.multiplyScalar(1/e)}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this}clamp(e,t){return this.x=Oe(this.x,e.x,t.x),this.y=Oe(this.y,e.y,t.y),this.z=Oe(this.z,e.z,t.z),this}clampScalar(e,t){return this.x=Oe(this.x,e,t),this.y=Oe(this.y,e,t),this.z=Oe(this.z,e,t),this}clampLength(e,t){const i=this.length();return this.divideScalar(i||1).multiplyScalar(Oe(i,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this}lerpVectors(e,t,i){return this.x=e.x+(t.x-e.x)*i,this.y=e.y+(t.y-e.y)*i,this.z=e.z+(t.z-e.z)*i,this}cross(e){return this.crossVectors(this,e)}crossVectors(e,t){const i=e.x,r=e.y,s=e.z,a=t.x,o=t.y,l=t.z;return this.x=r*l-s*o,this.y=s*a-i*l,this.z=i*o-r*a,this}projectOnVector(e){const t=e.lengthSq();if(t===0)return this.set(0,0,0);const i=e.dot(this)/t;return this.copy(e).multiplyScalar(i)}projectOnPlane(e){return Oc.copy(this).projectOnVector(e),this.sub(Oc)}reflect(e){return this.sub(Oc.copy(e).multiplyScalar(2*this.dot(e)))}angleTo(e){const t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;const i=this.dot(e)/t;return Math.acos(Oe(i,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){const t=this.x-e.x,i=this.y-e.y,r=this.z-e.z;return t*t+i*i+r*r}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)+Math.abs(this.z-e.z)}setFromSpherical(e){return this.setFromSphericalCoords(e.radius,e.phi,e.theta)}setFromSphericalCoords(e,t,i){const r=Math.sin(t)*e;return this.x=r*Math.sin(i),this.y=Math.cos(t)*e,this.z=r*Math.cos(i),this}setFromCylindrical(e){return this.setFromCylindricalCoords(e.radius,e.theta,e.y)}setFromCylindricalCoords(e,t,i){return this.x=e*Math.sin(t),this.y=i,this.z=e*Math.cos(t),this}setFromMatrixPosition(e){const t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this}setFromMatrixScale(e){const t=this.setFromMatrixColumn(e,0).length(),i=this.setFromMatrixColumn(e,1).length(),r=this.setFromMatrixColumn(e,2).length();return this.x=t,this.y=i,this.z=r,this}setFromMatrixColumn(e,t){return this.fromArray(e.elements,t*4)}setFromMatrix3Column(e,t){return this.fromArray(e.elements,t*3)}setFromEuler(e){return this.x=e._x,this.y=e._y,this.z=e._z,this}setFromColor(e){return this.x=e.r,this.y=e.g,this.z=e.b,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){const e=Math.random()*Math.PI*2,t=Math.random()*2-1,i=Math.sqrt(1-t*t);return this.x=i*Math.cos(e),this.y=t,this.z=i*Math.sin(e),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}}const Oc=new N,Ud=new ki;class Fe{static{this.prototype.isMatrix3=!0}constructor(e,t,i,r,s,a,o,l,c){this.elements=[1,0,0,0,1,0,0,0,1],e!==void 0&&this.set(e,t,i,r,s,a,o,l,c)}set(e,t,i,r,s,a,o,l,c){const f=this.elements;return f[0]=e,f[1]=r,f[2]=o,f[3]=t,f[4]=s,f[5]=l,f[6]=i,f[7]=a,f[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(e){const t=this.elements,i=e.elements;return t[0]=i[0],t[1]=i[1],t[2]=i[2],t[3]=i[3],t[4]=i[4],t[5]=i[5],t[6]=i[6],t[7]=i[7],t[8]=i[8],this}extractBasis(e,t,i){return e.setFromMatrix3Column(this,0),t.setFromMatrix3Column(this,1),i.setFromMatrix3Column(this,2),this}setFromMatrix4(e){const t=e.elements;return this.set(t[0],t[4],t[8],t[1],t[5],t[9],t[2],t[6],t[10]),this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){const i=e.elements,r=t.elements,s=this.elements,a=i[0],o=i[3],l=i[6],c=i[1],f=i[4],d=i[7],u=i[2],h=i[5],g=i[8],x=r[0],m=r[3],p=r[6],v=r[1],y=r[4],S=r[7],E=r[2],A=r[5],_=r[8];return s[0]=a*x+o*v+l*E,s[3]=a*m+o*y+l*A,s[6]=a*p+o*S+l*_,s[1]=c*x+f*v+d*E,s[4]=c*m+f*y+d*A,s[7]=c*p+f*S+d*_,s[2]=u*x+h*v+g*E,s[5]=u*m+h*y+g*A,s[8]=u*p+h*S+g*_,this}multiplyScalar(e){const t=this.elements;return t[0]*=e,t[3]*=e,t[6]*=e,t[1]*=e,t[4]*=e,t[7]*=e,t[2]*=e,t[5]*=e,t[8]*=e,this}determinant(){const e=this.elements,t=e[0],i=e[1],r=e[2],s=e[3],a=e[4],o=e[5],l=e[6],c=e[7],f=e[8];return t*a*f-t*o*c-i*s*f+i*o*l+r*s*c-r*a*l}invert(){const e=this.elements,t=e[0],i=e[1],r=e[2],s=e[3],a=e[4],o=e[5],l=e[6],c=e[7],f=e[8],d=f*a-o*c,u=o*l-f*s,h=c*s-a*l,g=t*d+i*u+r*h;if(g===0)return this.set(0,0,0,0,0,0,0,0,0);const x=1/g;return e[0]=d*x,e[1]=(r*c-f*i)*x,e[2]=(o*i-r*a)*x,e[3]=u*x,e[4]=(f*t-r*l)*x,e[5]=(r*s-o*t)*x,e[6]=h*x,e[7]=(i*l-c*t)*x,e[8]=(a*t-i*s)*x,this}transpose(){let e;const t=this.elements;return e=t[1],t[1]=t[3],t[3]=e,e=t[2],t[2]=t[6],t[6]=e,e=t[5],t[5]=t[7],t[7]=e,this}getNormalMatrix(e){return this.setFromMatrix4(e).invert().transpose()}transposeIntoArray(e){const t=this.elements;return e[0]=t[0],e[1]=t[3],e[2]=t[6],e[3]=t[1],e[4]=t[4],e[5]=t[7],e[6]=t[2],e[7]=t[5],e[8]=t[8],this}setUvTransform(e,t,i,r,s,a,o){const l=Math.cos(s),c=Math.sin(s);return this.set(i*l,i*c,-i*(l*a+c*o)+a+e,-r*c,r*l,-r*(-c*a+l*o)+o+t,0,0,1),this}scale(e,t){return $a("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(Bc.makeScale(e,t)),this}rotate(e){return $a("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(Bc.makeRotation(-e)),this}translate(e,t){return $a("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(Bc.makeTranslation(e,t)),this}makeTranslation(e,t){return e.isVector2?this.set(1,0,e.x,0,1,e.y,0,0,1):this.set(1,0,e,0,1,t,0,0,1),this}makeRotation(e){const t=Math.cos(e),i=Math.sin(e);return this.set(t,-i,0,i,t,0,0,0,1),this}makeScale(e,t){return this.set(e,0,0,0,t,0,0,0,1),this}equals(e){const t=this.elements,i=e.elements;for(let r=0;r<9;r++)if(t[r]!==i[r])return!1;return!0}fromArray(e,t=0){for(let i=0;i<9;i++)this.elements[i]=e[i+t];return this}toArray(e=[],t=0){const i=this.elements;return e[t]=i[0],e[t+1]=i[1],e[t+2]=i[2],e[t+3]=i[3],e[t+4]=i[4],e[t+5]=i[5],e[t+6]=i[6],e[t+7]=i[7],e[t+8]=i[8],e}clone(){return new this.constructor().fromArray(this.elements)}}const Bc=new Fe,Fd=new Fe().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),Od=new Fe().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function d_(){const n={enabled:!0,workingColorSpace:Ha,spaces:{},convert:function(r,s,a){return this.enabled===!1||s===a||!s||!a||(this.spaces[s].transfer===nt&&(r.r=gi(r.r),r.g=gi(r.g),r.b=gi(r.b)),this.spaces[s].primaries!==this.spaces[a].primaries&&(r.applyMatrix3(this.spaces[s].toXYZ),r.applyMatrix3(this.spaces[a].fromXYZ)),this.spaces[a].transfer===nt&&(r.r=$r(r.r),r.g=$r(r.g),r.b=$r(r.b))),r},workingToColorSpace:function(r,s){return this.convert(r,this.workingColorSpace,s)},colorSpaceToWorking:function(r,s){return this.convert(r,s,this.workingColorSpace)},getPrimaries:function(r){return this.spaces[r].primaries},getTransfer:function(r){return r===Bi?Ga:this.spaces[r].transfer},getToneMappingMode:function(r){return this.spaces[r].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(r,s=this.workingColorSpace){return r.fromArray(this.spaces[s].luminanceCoefficients)},define:function(r){Object.assign(this.spaces,r)},_getMatrix:function(r,s,a){return r.copy(this.spaces[a].fromXYZ).multiply(this.spaces[s].toXYZ)},_getDrawingBufferColorSpace:function(r){return this.spaces[r].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(r=this.workingColorSpace){return this.spaces[r].workingColorSpaceConfig.unpackColorSpace}},e=[.64,.33,.3,.6,.15,.06],t=[.2126,.7152,.0722],i=[.3127,.329];return n.define({[Ha]:{primaries:e,whitePoint:i,transfer:Ga,toXYZ:Fd,fromXYZ:Od,luminanceCoefficients:t,workingColorSpaceConfig:{unpackColorSpace:Sn},outputColorSpaceConfig:{drawingBufferColorSpace:Sn}},[Sn]:{primaries:e,whitePoint:i,transfer:nt,toXYZ:Fd,fromXYZ:Od,luminanceCoefficients:t,outputColorSpaceConfig:{drawingBufferColorSpace:Sn}}}),n}const Ye=d_();function gi(n){return n<.04045?n*.0773993808:Math.pow(n*.9478672986+.0521327014,2.4)}function $r(n){return n<.0031308?n*12.92:1.055*Math.pow(n,.41666)-.055}let Xr;class h_{static getDataURL(e,t="image/png"){if(/^data:/i.test(e.src)||typeof HTMLCanvasElement>"u")return e.src;let i;if(e instanceof HTMLCanvasElement)i=e;else{Xr===void 0&&(Xr=Wa("canvas")),Xr.width=e.width,Xr.height=e.height;const r=Xr.getContext("2d");e instanceof ImageData?r.putImageData(e,0,0):r.drawImage(e,0,0,e.width,e.height),i=Xr}return i.toDataURL(t)}static sRGBToLinear(e){if(typeof HTMLImageElement<"u"&&e instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&e instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&e instanceof ImageBitmap){const t=Wa("canvas");t.width=e.width,t.height=e.height;const i=t.getContext("2d");i.drawImage(e,0,0,e.width,e.height);const r=i.getImageData(0,0,e.width,e.height),s=r.data;for(let a=0;a<s.length;a++)s[a]=gi(s[a]/255)*255;return i.putImageData(r,0,0),t}else if(e.data){const t=e.data.slice(0);for(let i=0;i<t.length;i++)t instanceof Uint8Array||t instanceof Uint8ClampedArray?t[i]=Math.floor(gi(t[i]/255)*255):t[i]=gi(t[i]);return{data:t,width:e.width,height:e.height}}else return Le("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),e}}let p_=0;class kc{constructor(e=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:p_++}),this.uuid=Vs(),this.data=e,this.dataReady=!0,this.version=0}getSize(e){const t=this.data;return typeof HTMLVideoElement<"u"&&t instanceof HTMLVideoElement?e.set(t.videoWidth,t.videoHeight,0):typeof VideoFrame<"u"&&t instanceof VideoFrame?e.set(t.displayWidth,t.displayHeight,0):t!==null?e.set(t.width||0,t.height||0,t.depth||0):e.set(0,0,0),e}set needsUpdate(e){e===!0&&this.version++}toJSON(e){const t=e===void 0||typeof e=="string";if(!t&&e.images[this.uuid]!==void 0)return e.images[this.uuid];const i={uuid:this.uuid,url:""},r=this.data;if(r!==null){let s;if(Array.isArray(r)){s=[];for(let a=0,o=r.length;a<o;a++)r[a].isDataTexture?s.push(zc(r[a].image)):s.push(zc(r[a]))}else s=zc(r);i.url=s}return t||(e.images[this.uuid]=i),i}}function zc(n){return typeof HTMLImageElement<"u"&&n instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&n instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&n instanceof ImageBitmap?h_.getDataURL(n):n.data?{data:Array.from(n.data),width:n.width,height:n.height,type:n.data.constructor.name}:(Le("Texture: Unable to serialize Texture."),{})}let m_=0;const Hc=new N;class tn extends pr{constructor(e=tn.DEFAULT_IMAGE,t=tn.DEFAULT_MAPPING,i=mi,r=mi,s=on,a=Ui,o=$n,l=xn,c=tn.DEFAULT_ANISOTROPY,f=Bi){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:m_++}),this.uuid=Vs(),this.name="",this.source=new kc(e),this.mipmaps=[],this.mapping=t,this.channel=0,this.wrapS=i,this.wrapT=r,this.magFilter=s,this.minFilter=a,this.anisotropy=c,this.format=o,this.internalFormat=null,this.type=l,this.offset=new We(0,0),this.repeat=new We(1,1),this.center=new We(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new Fe,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=f,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(e&&e.depth&&e.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(Hc).x}get height(){return this.source.getSize(Hc).y}get depth(){return this.source.getSize(Hc).z}get image(){return this.source.data}set image(e){this.source.data=e}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(e){return this.name=e.name,this.source=e.source,this.mipmaps=e.mipmaps.slice(0),this.mapping=e.mapping,this.channel=e.channel,this.wrapS=e.wrapS,this.wrapT=e.wrapT,this.magFilter=e.magFilter,this.minFilter=e.minFilter,this.anisotropy=e.anisotropy,this.format=e.format,this.internalFormat=e.internalFormat,this.type=e.type,this.normalized=e.normalized,this.offset.copy(e.offset),this.repeat.copy(e.repeat),this.center.copy(e.center),this.rotation=e.rotation,this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrix.copy(e.matrix),this.generateMipmaps=e.generateMipmaps,this.mipmapsAutoUpdate=e.mipmapsAutoUpdate,this.premultiplyAlpha=e.premultiplyAlpha,this.flipY=e.flipY,this.unpackAlignment=e.unpackAlignment,this.colorSpace=e.colorSpace,this.renderTarget=e.renderTarget,this.isRenderTargetTexture=e.isRenderTargetTexture,this.isPMREMTexture=e.isPMREMTexture,this.isArrayTexture=e.isArrayTexture,this.userData=JSON.parse(JSON.stringify(e.userData)),this.needsUpdate=!0,this}setValues(e){for(const t in e){const i=e[t];if(i===void 0){Le(`Texture.setValues(): parameter '${t}' has value of undefined.`);continue}const r=this[t];if(r===void 0){Le(`Texture.setValues(): property '${t}' does not exist.`);continue}r&&i&&r.isVector2&&i.isVector2||r&&i&&r.isVector3&&i.isVector3||r&&i&&r.isMatrix3&&i.isMatrix3?r.copy(i):this[t]=i}}toJSON(e){const t=e===void 0||typeof e=="string";if(!t&&e.textures[this.uuid]!==void 0)return e.textures[this.uuid];const i={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(e).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(i.userData=this.userData),t||(e.textures[this.uuid]=i),i}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(e){if(this.mapping!==Sd)return e;if(e.applyMatrix3(this.matrix),e.x<0||e.x>1)switch(this.wrapS){case Xl:e.x=e.x-Math.floor(e.x);break;case mi:e.x=e.x<0?0:1;break;case ql:Math.abs(Math.floor(e.x)%2)===1?e.x=Math.ceil(e.x)-e.x:e.x=e.x-Math.floor(e.x);break}if(e.y<0||e.y>1)switch(this.wrapT){case Xl:e.y=e.y-Math.floor(e.y);break;case mi:e.y=e.y<0?0:1;break;case ql:Math.abs(Math.floor(e.y)%2)===1?e.y=Math.ceil(e.y)-e.y:e.y=e.y-Math.floor(e.y);break}return this.flipY&&(e.y=1-e.y),e}set needsUpdate(e){e===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(e){e===!0&&this.pmremVersion++}}tn.DEFAULT_IMAGE=null,tn.DEFAULT_MAPPING=Sd,tn.DEFAULT_ANISOTROPY=1;class ot{static{this.prototype.isVector4=!0}constructor(e=0,t=0,i=0,r=1){this.x=e,this.y=t,this.z=i,this.w=r}get width(){return this.z}set width(e){this.z=e}get height(){return this.w}set height(e){this.w=e}set(e,t,i,r){return this.x=e,this.y=t,this.z=i,this.w=r,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this.w=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setW(e){return this.w=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;case 3:this.w=t;break;default:throw new Error("THREE.Vector4: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this.w=e.w!==void 0?e.w:1,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this.w+=e.w,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this.w+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this.w=e.w+t.w,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this.w+=e.w*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this.w-=e.w,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this.w-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this.w=e.w-t.w,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this.w*=e.w,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this.w*=e,this}applyMatrix4(e){const t=this.x,i=this.y,r=this.z,s=this.w,a=e.elements;return this.x=a[0]*t+a[4]*i+a[8]*r+a[12]*s,this.y=a[1]*t+a[5]*i+a[9]*r+a[13]*s,this.z=a[2]*t+a[6]*i+a[10]*r+a[14]*s,this.w=a[3]*t+a[7]*i+a[11]*r+a[15]*s,this}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this.w/=e.w,this}divideScalar(e){return this.multiplyScalar(1/e)}setAxisAngleFromQuaternion(e){this.w=2*Math.acos(e.w);const t=Math.sqrt(1-e.w*e.w);return t<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=e.x/t,this.y=e.y/t,this.z=e.z/t),this}setAxisAngleFromRotationMatrix(e){let t,i,r,s;const l=e.elements,c=l[0],f=l[4],d=l[8],u=l[1],h=l[5],g=l[9],x=l[2],m=l[6],p=l[10];if(Math.abs(f-u)<.01&&Math.abs(d-x)<.01&&Math.abs(g-m)<.01){if(Math.abs(f+u)<.1&&Math.abs(d+x)<.1&&Math.abs(g+m)<.1&&Math.abs(c+h+p-3)<.1)return this.set(1,0,0,0),this;t=Math.PI;const y=(c+1)/2,S=(h+1)/2,E=(p+1)/2,A=(f+u)/4,_=(d+x)/4,b=(g+m)/4;return y>S&&y>E?y<.01?(i=0,r=.707106781,s=.707106781):(i=Math.sqrt(y),r=A/i,s=_/i):S>E?S<.01?(i=.707106781,r=0,s=.707106781):(r=Math.sqrt(S),i=A/r,s=b/r):E<.01?(i=.707106781,r=.707106781,s=0):(s=Math.sqrt(E),i=_/s,r=b/s),this.set(i,r,s,t),this}let v=Math.sqrt((m-g)*(m-g)+(d-x)*(d-x)+(u-f)*(u-f));return Math.abs(v)<.001&&(v=1),this.x=(m-g)/v,this.y=(d-x)/v,this.z=(u-f)/v,this.w=Math.acos((c+h+p-1)/2),this}setFromMatrixPosition(e){const t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this.w=t[15],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this.w=Math.min(this.w,e.w),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this.w=Math.max(this.w,e.w),this}clamp(e,t){return this.x=Oe(this.x,e.x,t.x),this.y=Oe(this.y,e.y,t.y),this.z=Oe(this.z,e.z,t.z),this.w=Oe(this.w,e.w,t.w),this}clampScalar(e,t){return this.x=Oe(this.x,e,t),this.y=Oe(this.y,e,t),this.z=Oe(this.z,e,t),this.w=Oe(this.w,e,t),this}clampLength(e,t){const i=this.length();return this.divideScalar(i||1).multiplyScalar(Oe(i,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z+this.w*e.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this.w+=(e.w-this.w)*t,this}lerpVectors(e,t,i){return this.x=e.x+(t.x-e.x)*i,this.y=e.y+(t.y-e.y)*i,this.z=e.z+(t.z-e.z)*i,this.w=e.w+(t.w-e.w)*i,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z&&e.w===this.w}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this.w=e[t+3],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e[t+3]=this.w,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this.w=e.getW(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}}class g_ extends pr{constructor(e=1,t=1,i={}){super(),i=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:on,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},i),this.isRenderTarget=!0,this.width=e,this.height=t,this.depth=i.depth,this.scissor=new ot(0,0,e,t),this.scissorTest=!1,this.viewport=new ot(0,0,e,t),this.textures=[];const r=i.count;for(let s=0;s<r;s++)this.textures[s]=new tn({width:e,height:t,depth:i.depth}),this.textures[s].isRenderTargetTexture=!0,this.textures[s].renderTarget=this;this._setTextureOptions(i),this.depthBuffer=i.depthBuffer,this.stencilBuffer=i.stencilBuffer,this.resolveColorBuffer=i.resolveColorBuffer,this.resolveDepthBuffer=i.resolveDepthBuffer,this.resolveStencilBuffer=i.resolveStencilBuffer,this.storeMultisampledColorBuffer=i.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=i.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=i.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=i.depthTexture,this.samples=i.samples,this.multiview=i.multiview,this.useArrayDepthTexture=i.useArrayDepthTexture}_setTextureOptions(e={}){const t={minFilter:on,generateMipmaps:!1,flipY:!1,internalFormat:null};e.mapping!==void 0&&(t.mapping=e.mapping),e.wrapS!==void 0&&(t.wrapS=e.wrapS),e.wrapT!==void 0&&(t.wrapT=e.wrapT),e.wrapR!==void 0&&(t.wrapR=e.wrapR),e.magFilter!==void 0&&(t.magFilter=e.magFilter),e.minFilter!==void 0&&(t.minFilter=e.minFilter),e.format!==void 0&&(t.format=e.format),e.type!==void 0&&(t.type=e.type),e.anisotropy!==void 0&&(t.anisotropy=e.anisotropy),e.colorSpace!==void 0&&(t.colorSpace=e.colorSpace),e.flipY!==void 0&&(t.flipY=e.flipY),e.generateMipmaps!==void 0&&(t.generateMipmaps=e.generateMipmaps),e.mipmapsAutoUpdate!==void 0&&(t.mipmapsAutoUpdate=e.mipmapsAutoUpdate),e.internalFormat!==void 0&&(t.internalFormat=e.internalFormat);for(let i=0;i<this.textures.length;i++)this.textures[i].setValues(t)}get texture(){return this.textures[0]}set texture(e){this.textures[0]=e}set depthTexture(e){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),e!==null&&e.renderTarget===null&&(e.renderTarget=this),this._depthTexture=e}get depthTexture(){return this._depthTexture}setSize(e,t,i=1){if(this.width!==e||this.height!==t||this.depth!==i){this.width=e,this.height=t,this.depth=i;for(let r=0,s=this.textures.length;r<s;r++)this.textures[r].image.width=e,this.textures[r].image.height=t,this.textures[r].image.depth=i,this.textures[r].isData3DTexture!==!0&&(this.textures[r].isArrayTexture=this.textures[r].image.depth>1);this.dispose()}this.viewport.set(0,0,e,t),this.scissor.set(0,0,e,t)}clone(){return new this.constructor().copy(this)}copy(e){this.width=e.width,this.height=e.height,this.depth=e.depth,this.scissor.copy(e.scissor),this.scissorTest=e.scissorTest,this.viewport.copy(e.viewport),this.textures.length=0;for(let t=0,i=e.textures.length;t<i;t++){this.textures[t]=e.textures[t].clone(),this.textures[t].isRenderTargetTexture=!0,this.textures[t].renderTarget=this;const r=Object.assign({},e.textures[t].image);this.textures[t].source=new kc(r)}if(this.depthBuffer=e.depthBuffer,this.stencilBuffer=e.stencilBuffer,this.resolveColorBuffer=e.resolveColorBuffer,this.resolveDepthBuffer=e.resolveDepthBuffer,this.resolveStencilBuffer=e.resolveStencilBuffer,this.storeMultisampledColorBuffer=e.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=e.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=e.storeMultisampledStencilBuffer,e.depthTexture!==null)if(e.depthTexture.renderTarget===e){const t=e.depthTexture.clone();t.renderTarget=null,this.depthTexture=t}else this.depthTexture=e.depthTexture;else this.depthTexture=null;return this.samples=e.samples,this.multiview=e.multiview,this.useArrayDepthTexture=e.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:"dispose"})}}class Dn extends g_{constructor(e=1,t=1,i={}){super(e,t,i),this.isWebGLRenderTarget=!0}}class Bd extends tn{constructor(e=null,t=1,i=1,r=1){super(null),this.isDataArrayTexture=!0,this.image={data:e,width:t,height:i,depth:r},this.magFilter=kt,this.minFilter=kt,this.wrapR=mi,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}addLayerUpdate(e){this.layerUpdates.add(e)}clearLayerUpdates(){this.layerUpdates.clear()}}class __ extends tn{constructor(e=null,t=1,i=1,r=1){super(null),this.isData3DTexture=!0,this.image={data:e,width:t,height:i,depth:r},this.magFilter=kt,this.minFilter=kt,this.wrapR=mi,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}}class tt{static{this.prototype.isMatrix4=!0}constructor(e,t,i,r,s,a,o,l,c,f,d,u,h,g,x,m){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],e!==void 0&&this.set(e,t,i,r,s,a,o,l,c,f,d,u,h,g,x,m)}set(e,t,i,r,s,a,o,l,c,f,d,u,h,g,x,m){const p=this.elements;return p[0]=e,p[4]=t,p[8]=i,p[12]=r,p[1]=s,p[5]=a,p[9]=o,p[13]=l,p[2]=c,p[6]=f,p[10]=d,p[14]=u,p[3]=h,p[7]=g,p[11]=x,p[15]=m,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new tt().fromArray(this.elements)}copy(e){const t=this.elements,i=e.elements;return t[0]=i[0],t[1]=i[1],t[2]=i[2],t[3]=i[3],t[4]=i[4],t[5]=i[5],t[6]=i[6],t[7]=i[7],t[8]=i[8],t[9]=i[9],t[10]=i[10],t[11]=i[11],t[12]=i[12],t[13]=i[13],t[14]=i[14],t[15]=i[15],this}copyPosition(e){const t=this.elements,i=e.elements;return t[12]=i[12],t[13]=i[13],t[14]=i[14],this}setFromMatrix3(e){const t=e.elements;return this.set(t[0],t[3],t[6],0,t[1],t[4],t[7],0,t[2],t[5],t[8],0,0,0,0,1),this}extractBasis(e,t,i){return this.determinantAffine()===0?(e.set(1,0,0),t.set(0,1,0),i.set(0,0,1),this):(e.setFromMatrixColumn(this,0),t.setFromMatrixColumn(this,1),i.setFromMatrixColumn(this,2),this)}makeBasis(e,t,i){return this.set(e.x,t.x,i.x,0,e.y,t.y,i.y,0,e.z,t.z,i.z,0,0,0,0,1),this}extractRotation(e){if(e.determinantAffine()===0)return this.identity();const t=this.elements,i=e.elements,r=1/qr.setFromMatrixColumn(e,0).length(),s=1/qr.setFromMatrixColumn(e,1).length(),a=1/qr.setFromMatrixColumn(e,2).length();return t[0]=i[0]*r,t[1]=i[1]*r,t[2]=i[2]*r,t[3]=0,t[4]=i[4]*s,t[5]=i[5]*s,t[6]=i[6]*s,t[7]=0,t[8]=i[8]*a,t[9]=i[9]*a,t[10]=i[10]*a,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromEuler(e){const t=this.elements,i=e.x,r=e.y,s=e.z,a=Math.cos(i),o=Math.sin(i),l=Math.cos(r),c=Math.sin(r),f=Math.cos(s),d=Math.sin(s);if(e.order==="XYZ"){const u=a*f,h=a*d,g=o*f,x=o*d;t[0]=l*f,t[4]=-l*d,t[8]=c,t[1]=h+g*c,t[5]=u-x*c,t[9]=-o*l,t[2]=x-u*c,t[6]=g+h*c,t[10]=a*l}else if(e.order==="YXZ"){const u=l*f,h=l*d,g=c*f,x=c*d;t[0]=u+x*o,t[4]=g*o-h,t[8]=a*c,t[1]=a*d,t[5]=a*f,t[9]=-o,t[2]=h*o-g,t[6]=x+u*o,t[10]=a*l}else if(e.order==="ZXY"){const u=l*f,h=l*d,g=c*f,x=c*d;t[0]=u-x*o,t[4]=-a*d,t[8]=g+h*o,t[1]=h+g*o,t[5]=a*f,t[9]=x-u*o,t[2]=-a*c,t[6]=o,t[10]=a*l}else if(e.order==="ZYX"){const u=a*f,h=a*d,g=o*f,x=o*d;t[0]=l*f,t[4]=g*c-h,t[8]=u*c+x,t[1]=l*d,t[5]=x*c+u,t[9]=h*c-g,t[2]=-c,t[6]=o*l,t[10]=a*l}else if(e.order==="YZX"){const u=a*l,h=a*c,g=o*l,x=o*c;t[0]=l*f,t[4]=x-u*d,t[8]=g*d+h,t[1]=d,t[5]=a*f,t[9]=-o*f,t[2]=-c*f,t[6]=h*d+g,t[10]=u-x*d}else if(e.order==="XZY"){const u=a*l,h=a*c,g=o*l,x=o*c;t[0]=l*f,t[4]=-d,t[8]=c*f,t[1]=u*d+x,t[5]=a*f,t[9]=h*d-g,t[2]=g*d-h,t[6]=o*f,t[10]=x*d+u}return t[3]=0,t[7]=0,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromQuaternion(e){return this.compose(v_,e,x_)}lookAt(e,t,i){const r=this.elements;return fn.subVectors(e,t),fn.lengthSq()===0&&(fn.z=1),fn.normalize(),zi.crossVectors(i,fn),zi.lengthSq()===0&&(Math.abs(i.z)===1?fn.x+=1e-4:fn.z+=1e-4,fn.normalize(),zi.crossVectors(i,fn)),zi.normalize(),Xa.crossVectors(fn,zi),r[0]=zi.x,r[4]=Xa.x,r[8]=fn.x,r[1]=zi.y,r[5]=Xa.y,r[9]=fn.y,r[2]=zi.z,r[6]=Xa.z,r[10]=fn.z,this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){const i=e.elements,r=t.elements,s=this.elements,a=i[0],o=i[4],l=i[8],c=i[12],f=i[1],d=i[5],u=i[9],h=i[13],g=i[2],x=i[6],m=i[10],p=i[14],v=i[3],y=i[7],S=i[11],E=i[15],A=r[0],_=r[4],b=r[8],I=r[12],R=r[1],P=r[5],D=r[9],O=r[13],L=r[2],k=r[6],V=r[10],W=r[14],te=r[3],X=r[7],j=r[11],ee=r[15];return s[0]=a*A+o*R+l*L+c*te,s[4]=a*_+o*P+l*k+c*X,s[8]=a*b+o*D+l*V+c*j,s[12]=a*I+o*O+l*W+c*ee,s[1]=f*A+d*R+u*L+h*te,s[5]=f*_+d*P+u*k+h*X,s[9]=f*b+d*D+u*V+h*j,s[13]=f*I+d*O+u*W+h*ee,s[2]=g*A+x*R+m*L+p*te,s[6]=g*_+x*P+m*k+p*X,s[10]=g*b+x*D+m*V+p*j,s[14]=g*I+x*O+m*W+p*ee,s[3]=v*A+y*R+S*L+E*te,s[7]=v*_+y*P+S*k+E*X,s[11]=v*b+y*D+S*V+E*j,s[15]=v*I+y*O+S*W+E*ee,this}multiplyScalar(e){const t=this.elements;return t[0]*=e,t[4]*=e,t[8]*=e,t[12]*=e,t[1]*=e,t[5]*=e,t[9]*=e,t[13]*=e,t[2]*=e,t[6]*=e,t[10]*=e,t[14]*=e,t[3]*=e,t[7]*=e,t[11]*=e,t[15]*=e,this}determinant(){const e=this.elements,t=e[0],i=e[4],r=e[8],s=e[12],a=e[1],o=e[5],l=e[9],c=e[13],f=e[2],d=e[6],u=e[10],h=e[14],g=e[3],x=e[7],m=e[11],p=e[15],v=l*h-c*u,y=o*h-c*d,S=o*u-l*d,E=a*h-c*f,A=a*u-l*f,_=a*d-o*f;return t*(x*v-m*y+p*S)-i*(g*v-m*E+p*A)+r*(g*y-x*E+p*_)-s*(g*S-x*A+m*_)}determinantAffine(){const e=this.elements,t=e[0],i=e[4],r=e[8],s=e[1],a=e[5],o=e[9],l=e[2],c=e[6],f=e[10];return t*(a*f-o*c)-i*(s*f-o*l)+r*(s*c-a*l)}transpose(){const e=this.elements;let t;return t=e[1],e[1]=e[4],e[4]=t,t=e[2],e[2]=e[8],e[8]=t,t=e[6],e[6]=e[9],e[9]=t,t=e[3],e[3]=e[12],e[12]=t,t=e[7],e[7]=e[13],e[13]=t,t=e[11],e[11]=e[14],e[14]=t,this}setPosition(e,t,i){const r=this.elements;return e.isVector3?(r[12]=e.x,r[13]=e.y,r[14]=e.z):(r[12]=e,r[13]=t,r[14]=i),this}invert(){const e=this.elements,t=e[0],i=e[1],r=e[2],s=e[3],a=e[4],o=e[5],l=e[6],c=e[7],f=e[8],d=e[9],u=e[10],h=e[11],g=e[12],x=e[13],m=e[14],p=e[15],v=t*o-i*a,y=t*l-r*a,S=t*c-s*a,E=i*l-r*o,A=i*c-s*o,_=r*c-s*l,b=f*x-d*g,I=f*m-u*g,R=f*p-h*g,P=d*m-u*x,D=d*p-h*x,O=u*p-h*m,L=v*O-y*D+S*P+E*R-A*I+_*b;if(L===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);const k=1/L;return e[0]=(o*O-l*D+c*P)*k,e[1]=(r*D-i*O-s*P)*k,e[2]=(x*_-m*A+p*E)*k,e[3]=(u*A-d*_-h*E)*k,e[4]=(l*R-a*O-c*I)*k,e[5]=(t*O-r*R+s*I)*k,e[6]=(m*S-g*_-p*y)*k,e[7]=(f*_-u*S+h*y)*k,e[8]=(a*D-o*R+c*b)*k,e[9]=(i*R-t*D-s*b)*k,e[10]=(g*A-x*S+p*v)*k,e[11]=(d*S-f*A-h*v)*k,e[12]=(o*I-a*P-l*b)*k,e[13]=(t*P-i*I+r*b)*k,e[14]=(x*y-g*E-m*v)*k,e[15]=(f*E-d*y+u*v)*k,this}scale(e){const t=this.elements,i=e.x,r=e.y,s=e.z;return t[0]*=i,t[4]*=r,t[8]*=s,t[1]*=i,t[5]*=r,t[9]*=s,t[2]*=i,t[6]*=r,t[10]*=s,t[3]*=i,t[7]*=r,t[11]*=s,this}getMaxScaleOnAxis(){const e=this.elements,t=e[0]*e[0]+e[1]*e[1]+e[2]*e[2],i=e[4]*e[4]+e[5]*e[5]+e[6]*e[6],r=e[8]*e[8]+e[9]*e[9]+e[10]*e[10];return Math.sqrt(Math.max(t,i,r))}makeTranslation(e,t,i){return e.isVector3?this.set(1,0,0,e.x,0,1,0,e.y,0,0,1,e.z,0,0,0,1):this.set(1,0,0,e,0,1,0,t,0,0,1,i,0,0,0,1),this}makeRotationX(e){const t=Math.cos(e),i=Math.sin(e);return this.set(1,0,0,0,0,t,-i,0,0,i,t,0,0,0,0,1),this}makeRotationY(e){const t=Math.cos(e),i=Math.sin(e);return this.set(t,0,i,0,0,1,0,0,-i,0,t,0,0,0,0,1),this}makeRotationZ(e){const t=Math.cos(e),i=Math.sin(e);return this.set(t,-i,0,0,i,t,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(e,t){const i=Math.cos(t),r=Math.sin(t),s=1-i,a=e.x,o=e.y,l=e.z,c=s*a,f=s*o;return this.set(c*a+i,c*o-r*l,c*l+r*o,0,c*o+r*l,f*o+i,f*l-r*a,0,c*l-r*o,f*l+r*a,s*l*l+i,0,0,0,0,1),this}makeScale(e,t,i){return this.set(e,0,0,0,0,t,0,0,0,0,i,0,0,0,0,1),this}makeShear(e,t,i,r,s,a){return this.set(1,i,s,0,e,1,a,0,t,r,1,0,0,0,0,1),this}compose(e,t,i){const r=this.elements,s=t._x,a=t._y,o=t._z,l=t._w,c=s+s,f=a+a,d=o+o,u=s*c,h=s*f,g=s*d,x=a*f,m=a*d,p=o*d,v=l*c,y=l*f,S=l*d,E=i.x,A=i.y,_=i.z;return r[0]=(1-(x+p))*E,r[1]=(h+S)*E,r[2]=(g-y)*E,r[3]=0,r[4]=(h-S)*A,r[5]=(1-(u+p))*A,r[6]=(m+v)*A,r[7]=0,r[8]=(g+y)*_,r[9]=(m-v)*_,r[10]=(1-(u+x))*_,r[11]=0,r[12]=e.x,r[13]=e.y,r[14]=e.z,r[15]=1,this}decompose(e,t,i){const r=this.elements;e.x=r[12],e.y=r[13],e.z=r[14];const s=this.determinantAffine();if(s===0)return i.set(1,1,1),t.identity(),this;let a=qr.set(r[0],r[1],r[2]).length();const o=qr.set(r[4],r[5],r[6]).length(),l=qr.set(r[8],r[9],r[10]).length();s<0&&(a=-a),In.copy(this);const c=1/a,f=1/o,d=1/l;return In.elements[0]*=c,In.elements[1]*=c,In.elements[2]*=c,In.elements[4]*=f,In.elements[5]*=f,In.elements[6]*=f,In.elements[8]*=d,In.elements[9]*=d,In.elements[10]*=d,t.setFromRotationMatrix(In),i.x=a,i.y=o,i.z=l,this}makePerspective(e,t,i,r,s,a,o=Ln,l=!1){const c=this.elements,f=2*s/(t-e),d=2*s/(i-r),u=(t+e)/(t-e),h=(i+r)/(i-r);let g,x;if(l)g=s/(a-s),x=a*s/(a-s);else if(o===Ln)g=-(a+s)/(a-s),x=-2*a*s/(a-s);else if(o===Va)g=-a/(a-s),x=-a*s/(a-s);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+o);return c[0]=f,c[4]=0,c[8]=u,c[12]=0,c[1]=0,c[5]=d,c[9]=h,c[13]=0,c[2]=0,c[6]=0,c[10]=g,c[14]=x,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(e,t,i,r,s,a,o=Ln,l=!1){const c=this.elements,f=2/(t-e),d=2/(i-r),u=-(t+e)/(t-e),h=-(i+r)/(i-r);let g,x;if(l)g=1/(a-s),x=a/(a-s);else if(o===Ln)g=-2/(a-s),x=-(a+s)/(a-s);else if(o===Va)g=-1/(a-s),x=-s/(a-s);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+o);return c[0]=f,c[4]=0,c[8]=0,c[12]=u,c[1]=0,c[5]=d,c[9]=0,c[13]=h,c[2]=0,c[6]=0,c[10]=g,c[14]=x,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(e){const t=this.elements,i=e.elements;for(let r=0;r<16;r++)if(t[r]!==i[r])return!1;return!0}fromArray(e,t=0){for(let i=0;i<16;i++)this.elements[i]=e[i+t];return this}toArray(e=[],t=0){const i=this.elements;return e[t]=i[0],e[t+1]=i[1],e[t+2]=i[2],e[t+3]=i[3],e[t+4]=i[4],e[t+5]=i[5],e[t+6]=i[6],e[t+7]=i[7],e[t+8]=i[8],e[t+9]=i[9],e[t+10]=i[10],e[t+11]=i[11],e[t+12]=i[12],e[t+13]=i[13],e[t+14]=i[14],e[t+15]=i[15],e}}const qr=new N,In=new tt,v_=new N(0,0,0),x_=new N(1,1,1),zi=new N,Xa=new N,fn=new N,kd=new tt,zd=new ki;class mr{constructor(e=0,t=0,i=0,r=mr.DEFAULT_ORDER){this.isEuler=!0,this._x=e,this._y=t,this._z=i,this._order=r}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get order(){return this._order}set order(e){this._order=e,this._onChangeCallback()}set(e,t,i,r=this._order){return this._x=e,this._y=t,this._z=i,this._order=r,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(e){return this._x=e._x,this._y=e._y,this._z=e._z,this._order=e._order,this._onChangeCallback(),this}setFromRotationMatrix(e,t=this._order,i=!0){const r=e.elements,s=r[0],a=r[4],o=r[8],l=r[1],c=r[5],f=r[9],d=r[2],u=r[6],h=r[10];switch(t){case"XYZ":this._y=Math.asin(Oe(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(-f,h),this._z=Math.atan2(-a,s)):(this._x=Math.atan2(u,c),this._z=0);break;case"YXZ":this._x=Math.asin(-Oe(f,-1,1)),Math.abs(f)<.9999999?(this._y=Math.atan2(o,h),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-d,s),this._z=0);break;case"ZXY":this._x=Math.asin(Oe(u,-1,1)),Math.abs(u)<.9999999?(this._y=Math.atan2(-d,h),this._z=Math.atan2(-a,c)):(this._y=0,this._z=Math.atan2(l,s));break;case"ZYX":this._y=Math.asin(-Oe(d,-1,1)),Math.abs(d)<.9999999?(this._x=Math.atan2(u,h),this._z=Math.atan2(l,s)):(this._x=0,this._z=Math.atan2(-a,c));break;case"YZX":this._z=Math.asin(Oe(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-f,c),this._y=Math.atan2(-d,s)):(this._x=0,this._y=Math.atan2(o,h));break;case"XZY":this._z=Math.asin(-Oe(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(u,c),this._y=Math.atan2(o,s)):(this._x=Math.atan2(-f,h),this._y=0);break;default:Le("Euler: .setFromRotationMatrix() encountered an unknown order: "+t)}return this._order=t,i===!0&&this._onChangeCallback(),this}setFromQuaternion(e,t,i){return kd.makeRotationFromQuaternion(e),this.setFromRotationMatrix(kd,t,i)}setFromVector3(e,t=this._order){return this.set(e.x,e.y,e.z,t)}reorder(e){return zd.setFromEuler(this),this.setFromQuaternion(zd,e)}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._order===this._order}fromArray(e){return this._x=e[0],this._y=e[1],this._z=e[2],e[3]!==void 0&&(this._order=e[3]),this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._order,e}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}}mr.DEFAULT_ORDER="XYZ";class Hd{constructor(){this.mask=1}set(e){this.mask=(1<<e|0)>>>0}enable(e){this.mask|=1<<e|0}enableAll(){this.mask=-1}toggle(e){this.mask^=1<<e|0}disable(e){this.mask&=~(1<<e|0)}disableAll(){this.mask=0}test(e){return(this.mask&e.mask)!==0}isEnabled(e){return(this.mask&(1<<e|0))!==0}}let S_=0;const Gd=new N,Yr=new ki,_i=new tt,qa=new N,Ws=new N,M_=new N,y_=new ki,Vd=new N(1,0,0),Wd=new N(0,1,0),$d=new N(0,0,1),Xd={type:"added"},b_={type:"removed"},Kr={type:"childadded",child:null},Gc={type:"childremoved",child:null};class ln extends pr{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:S_++}),this.uuid=Vs(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=ln.DEFAULT_UP.clone();const e=new N,t=new mr,i=new ki,r=new N(1,1,1);function s(){i.setFromEuler(t,!1)}function a(){t.setFromQuaternion(i,void 0,!1)}t._onChange(s),i._onChange(a),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:e},rotation:{configurable:!0,enumerable:!0,value:t},quaternion:{configurable:!0,enumerable:!0,value:i},scale:{configurable:!0,enumerable:!0,value:r},modelViewMatrix:{value:new tt},normalMatrix:{value:new Fe}}),this.matrix=new tt,this.matrixWorld=new tt,this.matrixAutoUpdate=ln.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=ln.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new Hd,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(e){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(e),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(e){return this.quaternion.premultiply(e),this}setRotationFromAxisAngle(e,t){this.quaternion.setFromAxisAngle(e,t)}setRotationFromEuler(e){this.quaternion.setFromEuler(e,!0)}setRotationFromMatrix(e){this.quaternion.setFromRotationMatrix(e)}setRotationFromQuaternion(e){this.quaternion.copy(e)}rotateOnAxis(e,t){return Yr.setFromAxisAngle(e,t),this.quaternion.multiply(Yr),this}rotateOnWorldAxis(e,t){return Yr.setFromAxisAngle(e,t),this.quaternion.premultiply(Yr),this}rotateX(e){return this.rotateOnAxis(Vd,e)}rotateY(e){return this.rotateOnAxis(Wd,e)}rotateZ(e){return this.rotateOnAxis($d,e)}translateOnAxis(e,t){return Gd.copy(e).applyQuaternion(this.quaternion),this.position.add(Gd.multiplyScalar(t)),this}translateX(e){return this.translateOnAxis(Vd,e)}translateY(e){return this.translateOnAxis(Wd,e)}translateZ(e){return this.translateOnAxis($d,e)}localToWorld(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(this.matrixWorld)}worldToLocal(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(_i.copy(this.matrixWorld).invert())}lookAt(e,t,i){e.isVector3?qa.copy(e):qa.set(e,t,i);const r=this.parent;this.updateWorldMatrix(!0,!1),Ws.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?_i.lookAt(Ws,qa,this.up):_i.lookAt(qa,Ws,this.up),this.quaternion.setFromRotationMatrix(_i),r&&(_i.extractRotation(r.matrixWorld),Yr.setFromRotationMatrix(_i),this.quaternion.premultiply(Yr.invert()))}add(e){if(arguments.length>1){for(let t=0;t<arguments.length;t++)this.add(arguments[t]);return this}return e===this?(Qe("Object3D.add: object can't be added as a child of itself.",e),this):(e&&e.isObject3D?(e.removeFromParent(),e.parent=this,this.children.push(e),e.dispatchEvent(Xd),Kr.child=e,this.dispatchEvent(Kr),Kr.child=null):Qe("Object3D.add: object not an instance of THREE.Object3D.",e),this)}remove(e){if(arguments.length>1){for(let i=0;i<arguments.length;i++)this.remove(arguments[i]);return this}const t=this.children.indexOf(e);return t!==-1&&(e.parent=null,this.children.splice(t,1),e.dispatchEvent(b_),Gc.child=e,this.dispatchEvent(Gc),Gc.child=null),this}removeFromParent(){const e=this.parent;return e!==null&&e.remove(this),this}clear(){return this.remove(...this.children)}attach(e){return this.updateWorldMatrix(!0,!1),_i.copy(this.matrixWorld).invert(),e.parent!==null&&(e.parent.updateWorldMatrix(!0,!1),_i.multiply(e.parent.matrixWorld)),e.applyMatrix4(_i),e.removeFromParent(),e.parent=this,this.children.push(e),e.updateWorldMatrix(!1,!0),e.dispatchEvent(Xd),Kr.child=e,this.dispatchEvent(Kr),Kr.child=null,this}getObjectById(e){return this.getObjectByProperty("id",e)}getObjectByName(e){return this.getObjectByProperty("name",e)}getObjectByProperty(e,t){if(this[e]===t)return this;for(let i=0,r=this.children.length;i<r;i++){const a=this.children[i].getObjectByProperty(e,t);if(a!==void 0)return a}}getObjectsByProperty(e,t,i=[]){this[e]===t&&i.push(this);const r=this.children;for(let s=0,a=r.length;s<a;s++)r[s].getObjectsByProperty(e,t,i);return i}getWorldPosition(e){return this.updateWorldMatrix(!0,!1),e.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(Ws,e,M_),e}getWorldScale(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(Ws,y_,e),e}getWorldDirection(e){this.updateWorldMatrix(!0,!1);const t=this.matrixWorld.elements;return e.set(t[8],t[9],t[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(e){e(this);const t=this.children;for(let i=0,r=t.length;i<r;i++)t[i].traverse(e)}traverseVisible(e){if(this.visible===!1)return;e(this);const t=this.children;for(let i=0,r=t.length;i<r;i++)t[i].traverseVisible(e)}traverseAncestors(e){const t=this.parent;t!==null&&(e(t),t.traverseAncestors(e))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);const e=this.pivot;if(e!==null){const t=e.x,i=e.y,r=e.z,s=this.matrix.elements;s[12]+=t-s[0]*t-s[4]*i-s[8]*r,s[13]+=i-s[1]*t-s[5]*i-s[9]*r,s[14]+=r-s[2]*t-s[6]*i-s[10]*r}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(e){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||e)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,e=!0);const t=this.children;for(let i=0,r=t.length;i<r;i++)t[i].updateMatrixWorld(e)}updateWorldMatrix(e,t,i=!1){const r=this.parent;if(e===!0&&r!==null&&r.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||i)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,i=!0),t===!0){const s=this.children;for(let a=0,o=s.length;a<o;a++)s[a].updateWorldMatrix(!1,!0,i)}}toJSON(e){const t=e===void 0||typeof e=="string",i={};t&&(e={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},i.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});const r={};r.uuid=this.uuid,r.type=this.type,r.name=this.name,r.castShadow=this.castShadow,r.receiveShadow=this.receiveShadow,r.visible=this.visible,r.frustumCulled=this.frustumCulled,r.renderOrder=this.renderOrder,r.static=this.static,r.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(r.userData=this.userData),r.layers=this.layers.mask,r.matrix=this.matrix.toArray(),r.up=this.up.toArray(),this.pivot!==null&&(r.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(r.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(r.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(r.type="InstancedMesh",r.count=this.count,r.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(r.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(r.type="BatchedMesh",r.perObjectFrustumCulled=this.perObjectFrustumCulled,r.sortObjects=this.sortObjects,r.drawRanges=this._drawRanges,r.reservedRanges=this._reservedRanges,r.geometryInfo=this._geometryInfo.map(o=>({...o,boundingBox:o.boundingBox?o.boundingBox.toJSON():void 0,boundingSphere:o.boundingSphere?o.boundingSphere.toJSON():void 0})),r.instanceInfo=this._instanceInfo.map(o=>({...o})),r.availableInstanceIds=this._availableInstanceIds.slice(),r.availableGeometryIds=this._availableGeometryIds.slice(),r.nextIndexStart=this._nextIndexStart,r.nextVertexStart=this._nextVertexStart,r.geometryCount=this._geometryCount,r.maxInstanceCount=this._maxInstanceCount,r.maxVertexCount=this._maxVertexCount,r.maxIndexCount=this._maxIndexCount,r.geometryInitialized=this._geometryInitialized,r.matricesTexture=this._matricesTexture.toJSON(e),r.indirectTexture=this._indirectTexture.toJSON(e),this._colorsTexture!==null&&(r.colorsTexture=this._colorsTexture.toJSON(e)),this.boundingSphere!==null&&(r.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(r.boundingBox=this.boundingBox.toJSON()));function s(o,l){return o[l.uuid]===void 0&&(o[l.uuid]=l.toJSON(e)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?r.background=this.background.toJSON():this.background.isTexture&&(r.background=this.background.toJSON(e).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(r.environment=this.environment.toJSON(e).uuid);else if(this.isMesh||this.isLine||this.isPoints){r.geometry=s(e.geometries,this.geometry);const o=this.geometry.parameters;if(o!==void 0&&o.shapes!==void 0){const l=o.shapes;if(Array.isArray(l))for(let c=0,f=l.length;c<f;c++){const d=l[c];s(e.shapes,d)}else s(e.shapes,l)}}if(this.isSkinnedMesh&&(r.bindMode=this.bindMode,r.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(s(e.skeletons,this.skeleton),r.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){const o=[];for(let l=0,c=this.material.length;l<c;l++)o.push(s(e.materials,this.material[l]));r.material=o}else r.material=s(e.materials,this.material);if(this.children.length>0){r.children=[];for(let o=0;o<this.children.length;o++)r.children.push(this.children[o].toJSON(e).object)}if(this.animations.length>0){r.animations=[];for(let o=0;o<this.animations.length;o++){const l=this.animations[o];r.animations.push(s(e.animations,l))}}if(t){const o=a(e.geometries),l=a(e.materials),c=a(e.textures),f=a(e.images),d=a(e.shapes),u=a(e.skeletons),h=a(e.animations),g=a(e.nodes);o.length>0&&(i.geometries=o),l.length>0&&(i.materials=l),c.length>0&&(i.textures=c),f.length>0&&(i.images=f),d.length>0&&(i.shapes=d),u.length>0&&(i.skeletons=u),h.length>0&&(i.animations=h),g.length>0&&(i.nodes=g)}return i.object=r,i;function a(o){const l=[];for(const c in o){const f=o[c];delete f.metadata,l.push(f)}return l}}clone(e){return new this.constructor().copy(this,e)}copy(e,t=!0){if(this.name=e.name,this.up.copy(e.up),this.position.copy(e.position),this.rotation.order=e.rotation.order,this.quaternion.copy(e.quaternion),this.scale.copy(e.scale),this.pivot=e.pivot!==null?e.pivot.clone():null,this.matrix.copy(e.matrix),this.matrixWorld.copy(e.matrixWorld),this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrixWorldAutoUpdate=e.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=e.matrixWorldNeedsUpdate,this.layers.mask=e.layers.mask,this.visible=e.visible,this.castShadow=e.castShadow,this.receiveShadow=e.receiveShadow,this.frustumCulled=e.frustumCulled,this.renderOrder=e.renderOrder,this.static=e.static,this.animations=e.animations.slice(),this.userData=JSON.parse(JSON.stringify(e.userData)),t===!0)for(let i=0;i<e.children.length;i++){const r=e.children[i];this.add(r.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}}ln.DEFAULT_UP=new N(0,1,0),ln.DEFAULT_MATRIX_AUTO_UPDATE=!0,ln.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;class Ya extends ln{constructor(){super(),this.isGroup=!0,this.type="Group"}}const E_={type:"move"};class Vc{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new Ya,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new Ya,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new N,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new N),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new Ya,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new N,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new N,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(e){return this._targetRay!==null&&this._targetRay.dispatchEvent(e),this._grip!==null&&this._grip.dispatchEvent(e),this._hand!==null&&this._hand.dispatchEvent(e),this}connect(e){if(e&&e.hand){const t=this._hand;if(t)for(const i of e.hand.values())this._getHandJoint(t,i)}return this.dispatchEvent({type:"connected",data:e}),this}disconnect(e){return this.dispatchEvent({type:"disconnected",data:e}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(e,t,i){let r=null,s=null,a=null;const o=this._targetRay,l=this._grip,c=this._hand;if(e&&t.session.visibilityState!=="visible-blurred"){if(c&&e.hand){a=!0;for(const x of e.hand.values()){const m=t.getJointPose(x,i),p=this._getHandJoint(c,x);m!==null&&(p.matrix.fromArray(m.transform.matrix),p.matrix.decompose(p.position,p.quaternion,p.scale),p.matrixWorldNeedsUpdate=!0,p.jointRadius=m.radius),p.visible=m!==null}const f=c.joints["index-finger-tip"],d=c.joints["thumb-tip"],u=f.position.distanceTo(d.position),h=.02,g=.005;c.inputState.pinching&&u>h+g?(c.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:e.handedness,target:this})):!c.inputState.pinching&&u<=h-g&&(c.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:e.handedness,target:this}))}else l!==null&&e.gripSpace&&(s=t.getPose(e.gripSpace,i),s!==null&&(l.matrix.fromArray(s.transform.matrix),l.matrix.decompose(l.position,l.quaternion,l.scale),l.matrixWorldNeedsUpdate=!0,s.linearVelocity?(l.hasLinearVelocity=!0,l.linearVelocity.copy(s.linearVelocity)):l.hasLinearVelocity=!1,s.angularVelocity?(l.hasAngularVelocity=!0,l.angularVelocity.copy(s.angularVelocity)):l.hasAngularVelocity=!1,l.eventsEnabled&&l.dispatchEvent({type:"gripUpdated",data:e,target:this})));o!==null&&(r=t.getPose(e.targetRaySpace,i),r===null&&s!==null&&(r=s),r!==null&&(o.matrix.fromArray(r.transform.matrix),o.matrix.decompose(o.position,o.quaternion,o.scale),o.matrixWorldNeedsUpdate=!0,r.linearVelocity?(o.hasLinearVelocity=!0,o.linearVelocity.copy(r.linearVelocity)):o.hasLinearVelocity=!1,r.angularVelocity?(o.hasAngularVelocity=!0,o.angularVelocity.copy(r.angularVelocity)):o.hasAngularVelocity=!1,this.dispatchEvent(E_)))}return o!==null&&(o.visible=r!==null),l!==null&&(l.visible=s!==null),c!==null&&(c.visible=a!==null),this}_getHandJoint(e,t){if(e.joints[t.jointName]===void 0){const i=new Ya;i.matrixAutoUpdate=!1,i.visible=!1,e.joints[t.jointName]=i,e.add(i)}return e.joints[t.jointName]}}const qd={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},Hi={h:0,s:0,l:0},Ka={h:0,s:0,l:0};function Wc(n,e,t){return t<0&&(t+=1),t>1&&(t-=1),t<1/6?n+(e-n)*6*t:t<1/2?e:t<2/3?n+(e-n)*6*(2/3-t):n}class Je{constructor(e,t,i){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(e,t,i)}set(e,t,i){if(t===void 0&&i===void 0){const r=e;r&&r.isColor?this.copy(r):typeof r=="number"?this.setHex(r):typeof r=="string"&&this.setStyle(r)}else this.setRGB(e,t,i);return this}setScalar(e){return this.r=e,this.g=e,this.b=e,this}setHex(e,t=Sn){return e=Math.floor(e),this.r=(e>>16&255)/255,this.g=(e>>8&255)/255,this.b=(e&255)/255,Ye.colorSpaceToWorking(this,t),this}setRGB(e,t,i,r=Ye.workingColorSpace){return this.r=e,this.g=t,this.b=i,Ye.colorSpaceToWorking(this,r),this}setHSL(e,t,i,r=Ye.workingColorSpace){if(e=l_(e,1),t=Oe(t,0,1),i=Oe(i,0,1),t===0)this.r=this.g=this.b=i;else{const s=i<=.5?i*(1+t):i+t-i*t,a=2*i-s;this.r=Wc(a,s,e+1/3),this.g=Wc(a,s,e),this.b=Wc(a,s,e-1/3)}return Ye.colorSpaceToWorking(this,r),this}setStyle(e,t=Sn){function i(s){s!==void 0&&parseFloat(s)<1&&Le("Color: Alpha component of "+e+" will be ignored.")}let r;if(r=/^(\w+)\(([^\)]*)\)/.exec(e)){let s;const a=r[1],o=r[2];switch(a){case"rgb":case"rgba":if(s=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(o))return i(s[4]),this.setRGB(Math.min(255,parseInt(s[1],10))/255,Math.min(255,parseInt(s[2],10))/255,Math.min(255,parseInt(s[3],10))/255,t);if(s=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(o))return i(s[4]),this.setRGB(Math.min(100,parseFloat(s[1]))/100,Math.min(100,parseFloat(s[2]))/100,Math.min(100,parseFloat(s[3]))/100,t);break;case"hsl":case"hsla":if(s=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(o))return i(s[4]),this.setHSL(parseFloat(s[1])/360,parseFloat(s[2])/100,parseFloat(s[3])/100,t);break;default:Le("Color: Unknown color model "+e)}}else if(r=/^\#([A-Fa-f\d]+)$/.exec(e)){const s=r[1],a=s.length;if(a===3)return this.setRGB(parseInt(s.charAt(0),16)/15,parseInt(s.charAt(1),16)/15,parseInt(s.charAt(2),16)/15,t);if(a===6)return this.setHex(parseInt(s,16),t);Le("Color: Invalid hex color "+e)}else if(e&&e.length>0)return this.setColorName(e,t);return this}setColorName(e,t=Sn){const i=qd[e.toLowerCase()];return i!==void 0?this.setHex(i,t):Le("Color: Unknown color "+e),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(e){return this.r=e.r,this.g=e.g,this.b=e.b,this}copySRGBToLinear(e){return this.r=gi(e.r),this.g=gi(e.g),this.b=gi(e.b),this}copyLinearToSRGB(e){return this.r=$r(e.r),this.g=$r(e.g),this.b=$r(e.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(e=Sn){return Ye.workingToColorSpace(Xt.copy(this),e),Math.round(Oe(Xt.r*255,0,255))*65536+Math.round(Oe(Xt.g*255,0,255))*256+Math.round(Oe(Xt.b*255,0,255))}getHexString(e=Sn){return("000000"+this.getHex(e).toString(16)).slice(-6)}getHSL(e,t=Ye.workingColorSpace){Ye.workingToColorSpace(Xt.copy(this),t);const i=Xt.r,r=Xt.g,s=Xt.b,a=Math.max(i,r,s),o=Math.min(i,r,s);let l,c;const f=(o+a)/2;if(o===a)l=0,c=0;else{const d=a-o;switch(c=f<=.5?d/(a+o):d/(2-a-o),a){case i:l=(r-s)/d+(r<s?6:0);break;case r:l=(s-i)/d+2;break;case s:l=(i-r)/d+4;break}l/=6}return e.h=l,e.s=c,e.l=f,e}getRGB(e,t=Ye.workingColorSpace){return Ye.workingToColorSpace(Xt.copy(this),t),e.r=Xt.r,e.g=Xt.g,e.b=Xt.b,e}getStyle(e=Sn){Ye.workingToColorSpace(Xt.copy(this),e);const t=Xt.r,i=Xt.g,r=Xt.b;return e!==Sn?`color(${e} ${t.toFixed(3)} ${i.toFixed(3)} ${r.toFixed(3)})`:`rgb(${Math.round(t*255)},${Math.round(i*255)},${Math.round(r*255)})`}offsetHSL(e,t,i){return this.getHSL(Hi),this.setHSL(Hi.h+e,Hi.s+t,Hi.l+i)}add(e){return this.r+=e.r,this.g+=e.g,this.b+=e.b,this}addColors(e,t){return this.r=e.r+t.r,this.g=e.g+t.g,this.b=e.b+t.b,this}addScalar(e){return this.r+=e,this.g+=e,this.b+=e,this}sub(e){return this.r=Math.max(0,this.r-e.r),this.g=Math.max(0,this.g-e.g),this.b=Math.max(0,this.b-e.b),this}multiply(e){return this.r*=e.r,this.g*=e.g,this.b*=e.b,this}multiplyScalar(e){return this.r*=e,this.g*=e,this.b*=e,this}lerp(e,t){return this.r+=(e.r-this.r)*t,this.g+=(e.g-this.g)*t,this.b+=(e.b-this.b)*t,this}lerpColors(e,t,i){return this.r=e.r+(t.r-e.r)*i,this.g=e.g+(t.g-e.g)*i,this.b=e.b+(t.b-e.b)*i,this}lerpHSL(e,t){this.getHSL(Hi),e.getHSL(Ka);const i=Uc(Hi.h,Ka.h,t),r=Uc(Hi.s,Ka.s,t),s=Uc(Hi.l,Ka.l,t);return this.setHSL(i,r,s),this}setFromVector3(e){return this.r=e.x,this.g=e.y,this.b=e.z,this}applyMatrix3(e){const t=this.r,i=this.g,r=this.b,s=e.elements;return this.r=s[0]*t+s[3]*i+s[6]*r,this.g=s[1]*t+s[4]*i+s[7]*r,this.b=s[2]*t+s[5]*i+s[8]*r,this}equals(e){return e.r===this.r&&e.g===this.g&&e.b===this.b}fromArray(e,t=0){return this.r=e[t],this.g=e[t+1],this.b=e[t+2],this}toArray(e=[],t=0){return e[t]=this.r,e[t+1]=this.g,e[t+2]=this.b,e}fromBufferAttribute(e,t){return this.r=e.getX(t),this.g=e.getY(t),this.b=e.getZ(t),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}}const Xt=new Je;Je.NAMES=qd;class Yd extends ln{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new mr,this.environmentIntensity=1,this.environmentRotation=new mr,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(e,t){return super.copy(e,t),this.background=e.background!==null?e.background.clone():null,this.environment=e.environment!==null?e.environment.clone():null,this.fog=e.fog!==null?e.fog.clone():null,this.backgroundBlurriness=e.backgroundBlurriness,this.backgroundIntensity=e.backgroundIntensity,this.backgroundRotation.copy(e.backgroundRotation),this.environmentIntensity=e.environmentIntensity,this.environmentRotation.copy(e.environmentRotation),this.overrideMaterial=e.overrideMaterial!==null?e.overrideMaterial.clone():null,this.matrixAutoUpdate=e.matrixAutoUpdate,this}toJSON(e){const t=super.toJSON(e);return this.fog!==null&&(t.object.fog=this.fog.toJSON()),t.object.backgroundBlurriness=this.backgroundBlurriness,t.object.backgroundIntensity=this.backgroundIntensity,t.object.backgroundRotation=this.backgroundRotation.toArray(),t.object.environmentIntensity=this.environmentIntensity,t.object.environmentRotation=this.environmentRotation.toArray(),t}}const Nn=new N,vi=new N,$c=new N,xi=new N,Zr=new N,Jr=new N,Kd=new N,Xc=new N,qc=new N,Yc=new N,Kc=new ot,Zc=new ot,Jc=new ot;class zt{constructor(e=new N,t=new N,i=new N){this.a=e,this.b=t,this.c=i}static getNormal(e,t,i,r){r.subVectors(i,t),Nn.subVectors(e,t),r.cross(Nn);const s=r.lengthSq();return s>0?r.multiplyScalar(1/Math.sqrt(s)):r.set(0,0,0)}static getBarycoord(e,t,i,r,s){Nn.subVectors(r,t),vi.subVectors(i,t),$c.subVectors(e,t);const a=Nn.dot(Nn),o=Nn.dot(vi),l=Nn.dot($c),c=vi.dot(vi),f=vi.dot($c),d=a*c-o*o;if(d===0)return s.set(0,0,0),null;const u=1/d,h=(c*l-o*f)*u,g=(a*f-o*l)*u;return s.set(1-h-g,g,h)}static containsPoint(e,t,i,r){return this.getBarycoord(e,t,i,r,xi)===null?!1:xi.x>=0&&xi.y>=0&&xi.x+xi.y<=1}static getInterpolation(e,t,i,r,s,a,o,l){return this.getBarycoord(e,t,i,r,xi)===null?(l.x=0,l.y=0,"z"in l&&(l.z=0),"w"in l&&(l.w=0),null):(l.setScalar(0),l.addScaledVector(s,xi.x),l.addScaledVector(a,xi.y),l.addScaledVector(o,xi.z),l)}static getInterpolatedAttribute(e,t,i,r,s,a){return Kc.setScalar(0),Zc.setScalar(0),Jc.setScalar(0),Kc.fromBufferAttribute(e,t),Zc.fromBufferAttribute(e,i),Jc.fromBufferAttribute(e,r),a.setScalar(0),a.addScaledVector(Kc,s.x),a.addScaledVector(Zc,s.y),a.addScaledVector(Jc,s.z),a}static isFrontFacing(e,t,i,r){return Nn.subVectors(i,t),vi.subVectors(e,t),Nn.cross(vi).dot(r)<0}set(e,t,i){return this.a.copy(e),this.b.copy(t),this.c.copy(i),this}setFromPointsAndIndices(e,t,i,r){return this.a.copy(e[t]),this.b.copy(e[i]),this.c.copy(e[r]),this}setFromAttributeAndIndices(e,t,i,r){return this.a.fromBufferAttribute(e,t),this.b.fromBufferAttribute(e,i),this.c.fromBufferAttribute(e,r),this}clone(){return new this.constructor().copy(this)}copy(e){return this.a.copy(e.a),this.b.copy(e.b),this.c.copy(e.c),this}getArea(){return Nn.subVectors(this.c,this.b),vi.subVectors(this.a,this.b),Nn.cross(vi).length()*.5}getMidpoint(e){return e.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(e){return zt.getNormal(this.a,this.b,this.c,e)}getPlane(e){return e.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(e,t){return zt.getBarycoord(e,this.a,this.b,this.c,t)}getInterpolation(e,t,i,r,s){return zt.getInterpolation(e,this.a,this.b,this.c,t,i,r,s)}containsPoint(e){return zt.containsPoint(e,this.a,this.b,this.c)}isFrontFacing(e){return zt.isFrontFacing(this.a,this.b,this.c,e)}intersectsBox(e){return e.intersectsTriangle(this)}closestPointToPoint(e,t){const i=this.a,r=this.b,s=this.c;let a,o;Zr.subVectors(r,i),Jr.subVectors(s,i),Xc.subVectors(e,i);const l=Zr.dot(Xc),c=Jr.dot(Xc);if(l<=0&&c<=0)return t.copy(i);qc.subVectors(e,r);const f=Zr.dot(qc),d=Jr.dot(qc);if(f>=0&&d<=f)return t.copy(r);const u=l*d-f*c;if(u<=0&&l>=0&&f<=0&&l-f>0)return a=l/(l-f),t.copy(i).addScaledVector(Zr,a);Yc.subVectors(e,s);const h=Zr.dot(Yc),g=Jr.dot(Yc);if(g>=0&&h<=g)return t.copy(s);const x=h*c-l*g;if(x<=0&&c>=0&&g<=0)return o=c/(c-g),t.copy(i).addScaledVector(Jr,o);const m=f*g-h*d;if(m<=0&&d-f>=0&&h-g>=0)return Kd.subVectors(s,r),o=(d-f)/(d-f+(h-g)),t.copy(r).addScaledVector(Kd,o);const p=1/(m+x+u);return a=x*p,o=u*p,t.copy(i).addScaledVector(Zr,a).addScaledVector(Jr,o)}equals(e){return e.a.equals(this.a)&&e.b.equals(this.b)&&e.c.equals(this.c)}}class nn{constructor(e=new N(1/0,1/0,1/0),t=new N(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=e,this.max=t}set(e,t){return this.min.copy(e),this.max.copy(t),this}setFromArray(e){this.makeEmpty();for(let t=0,i=e.length;t<i;t+=3)this.expandByPoint(Un.fromArray(e,t));return this}setFromBufferAttribute(e){this.makeEmpty();for(let t=0,i=e.count;t<i;t++)this.expandByPoint(Un.fromBufferAttribute(e,t));return this}setFromPoints(e){this.makeEmpty();for(let t=0,i=e.length;t<i;t++)this.expandByPoint(e[t]);return this}setFromCenterAndSize(e,t){const i=Un.copy(t).multiplyScalar(.5);return this.min.copy(e).sub(i),this.max.copy(e).add(i),this}setFromObject(e,t=!1){return this.makeEmpty(),this.expandByObject(e,t)}clone(){return new this.constructor().copy(this)}copy(e){return this.min.copy(e.min),this.max.copy(e.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(e){return this.isEmpty()?e.set(0,0,0):e.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(e){return this.isEmpty()?e.set(0,0,0):e.subVectors(this.max,this.min)}expandByPoint(e){return this.min.min(e),this.max.max(e),this}expandByVector(e){return this.min.sub(e),this.max.add(e),this}expandByScalar(e){return this.min.addScalar(-e),this.max.addScalar(e),this}expandByObject(e,t=!1){e.updateWorldMatrix(!1,!1);const i=e.geometry;if(i!==void 0){const s=i.getAttribute("position");if(t===!0&&s!==void 0&&e.isInstancedMesh!==!0&&e.isBatchedMesh!==!0)for(let a=0,o=s.count;a<o;a++)e.isMesh===!0?e.getVertexPosition(a,Un):Un.fromBufferAttribute(s,a),Un.applyMatrix4(e.matrixWorld),this.expandByPoint(Un);else e.boundingBox!==void 0?(e.boundingBox===null&&e.computeBoundingBox(),Za.copy(e.boundingBox)):(i.boundingBox===null&&i.computeBoundingBox(),Za.copy(i.boundingBox)),Za.applyMatrix4(e.matrixWorld),this.union(Za)}const r=e.children;for(let s=0,a=r.length;s<a;s++)this.expandByObject(r[s],t);return this}containsPoint(e){return e.x>=this.min.x&&e.x<=this.max.x&&e.y>=this.min.y&&e.y<=this.max.y&&e.z>=this.min.z&&e.z<=this.max.z}containsBox(e){return this.min.x<=e.min.x&&e.max.x<=this.max.x&&this.min.y<=e.min.y&&e.max.y<=this.max.y&&this.min.z<=e.min.z&&e.max.z<=this.max.z}getParameter(e,t){return t.set((e.x-this.min.x)/(this.max.x-this.min.x),(e.y-this.min.y)/(this.max.y-this.min.y),(e.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(e){return e.max.x>=this.min.x&&e.min.x<=this.max.x&&e.max.y>=this.min.y&&e.min.y<=this.max.y&&e.max.z>=this.min.z&&e.min.z<=this.max.z}intersectsSphere(e){return this.clampPoint(e.center,Un),Un.distanceToSquared(e.center)<=e.radius*e.radius}intersectsPlane(e){let t,i;return e.normal.x>0?(t=e.normal.x*this.min.x,i=e.normal.x*this.max.x):(t=e.normal.x*this.max.x,i=e.normal.x*this.min.x),e.normal.y>0?(t+=e.normal.y*this.min.y,i+=e.normal.y*this.max.y):(t+=e.normal.y*this.max.y,i+=e.normal.y*this.min.y),e.normal.z>0?(t+=e.normal.z*this.min.z,i+=e.normal.z*this.max.z):(t+=e.normal.z*this.max.z,i+=e.normal.z*this.min.z),t<=-e.constant&&i>=-e.constant}intersectsTriangle(e){if(this.isEmpty())return!1;this.getCenter($s),Ja.subVectors(this.max,$s),Qr.subVectors(e.a,$s),jr.subVectors(e.b,$s),es.subVectors(e.c,$s),Gi.subVectors(jr,Qr),Vi.subVectors(es,jr),gr.subVectors(Qr,es);let t=[0,-Gi.z,Gi.y,0,-Vi.z,Vi.y,0,-gr.z,gr.y,Gi.z,0,-Gi.x,Vi.z,0,-Vi.x,gr.z,0,-gr.x,-Gi.y,Gi.x,0,-Vi.y,Vi.x,0,-gr.y,gr.x,0];return!Qc(t,Qr,jr,es,Ja)||(t=[1,0,0,0,1,0,0,0,1],!Qc(t,Qr,jr,es,Ja))?!1:(Qa.crossVectors(Gi,Vi),t=[Qa.x,Qa.y,Qa.z],Qc(t,Qr,jr,es,Ja))}clampPoint(e,t){return t.copy(e).clamp(this.min,this.max)}distanceToPoint(e){return this.clampPoint(e,Un).distanceTo(e)}getBoundingSphere(e){return this.isEmpty()?e.makeEmpty():(this.getCenter(e.center),e.radius=this.getSize(Un).length()*.5),e}intersect(e){return this.min.max(e.min),this.max.min(e.max),this.isEmpty()&&this.makeEmpty(),this}union(e){return this.min.min(e.min),this.max.max(e.max),this}applyMatrix4(e){return this.isEmpty()?this:(Si[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(e),Si[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(e),Si[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(e),Si[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(e),Si[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(e),Si[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(e),Si[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(e),Si[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(e),this.setFromPoints(Si),this)}translate(e){return this.min.add(e),this.max.add(e),this}equals(e){return e.min.equals(this.min)&&e.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(e){return this.min.fromArray(e.min),this.max.fromArray(e.max),this}}const Si=[new N,new N,new N,new N,new N,new N,new N,new N],Un=new N,Za=new nn,Qr=new N,jr=new N,es=new N,Gi=new N,Vi=new N,gr=new N,$s=new N,Ja=new N,Qa=new N,_r=new N;function Qc(n,e,t,i,r){for(let s=0,a=n.length-3;s<=a;s+=3){_r.fromArray(n,s);const o=r.x*Math.abs(_r.x)+r.y*Math.abs(_r.y)+r.z*Math.abs(_r.z),l=e.dot(_r),c=t.dot(_r),f=i.dot(_r);if(Math.max(-Math.max(l,c,f),Math.min(l,c,f))>o)return!1}return!0}const Mt=new N,ja=new We;let w_=0;class Ht extends pr{constructor(e,t,i=!1){if(super(),Array.isArray(e))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:w_++}),this.name="",this.array=e,this.itemSize=t,this.count=e!==void 0?e.length/t:0,this.normalized=i,this.usage=i_,this.updateRanges=[],this.gpuType=Vn,this.version=0,this._normalizationScale=e!==void 0?Fc(e):void 0}onUploadCallback(){}set needsUpdate(e){e===!0&&this.version++}setUsage(e){return this.usage=e,this}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}copy(e){return this.name=e.name,this.array=new e.array.constructor(e.array),this.itemSize=e.itemSize,this.count=e.count,this.normalized=e.normalized,this.usage=e.usage,this.gpuType=e.gpuType,this._normalizationScale=e._normalizationScale,this}copyAt(e,t,i){e*=this.itemSize,i*=t.itemSize;for(let r=0,s=this.itemSize;r<s;r++)this.array[e+r]=t.array[i+r];return this}copyArray(e){return this.array.set(e),this}applyMatrix3(e){if(this.itemSize===2)for(let t=0,i=this.count;t<i;t++)ja.fromBufferAttribute(this,t),ja.applyMatrix3(e),this.setXY(t,ja.x,ja.y);else if(this.itemSize===3)for(let t=0,i=this.count;t<i;t++)Mt.fromBufferAttribute(this,t),Mt.applyMatrix3(e),this.setXYZ(t,Mt.x,Mt.y,Mt.z);return this}applyMatrix4(e){for(let t=0,i=this.count;t<i;t++)Mt.fromBufferAttribute(this,t),Mt.applyMatrix4(e),this.setXYZ(t,Mt.x,Mt.y,Mt.z);return this}applyNormalMatrix(e){for(let t=0,i=this.count;t<i;t++)Mt.fromBufferAttribute(this,t),Mt.applyNormalMatrix(e),this.setXYZ(t,Mt.x,Mt.y,Mt.z);return this}transformDirection(e){for(let t=0,i=this.count;t<i;t++)Mt.fromBufferAttribute(this,t),Mt.transformDirection(e),this.setXYZ(t,Mt.x,Mt.y,Mt.z);return this}set(e,t=0){return this.array.set(e,t),this}getComponent(e,t){let i=this.array[e*this.itemSize+t];return this.normalized&&(i=this._denormalize(i)),i}setComponent(e,t,i){return this.normalized&&(i=this._normalize(i)),this.array[e*this.itemSize+t]=i,this}getX(e){let t=this.array[e*this.itemSize];return this.normalized&&(t=this._denormalize(t)),t}setX(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize]=t,this}getY(e){let t=this.array[e*this.itemSize+1];return this.normalized&&(t=this._denormalize(t)),t}setY(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+1]=t,this}getZ(e){let t=this.array[e*this.itemSize+2];return this.normalized&&(t=this._denormalize(t)),t}setZ(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+2]=t,this}getW(e){let t=this.array[e*this.itemSize+3];return this.normalized&&(t=this._denormalize(t)),t}setW(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+3]=t,this}setXY(e,t,i){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),i=this._normalize(i)),this.array[e+0]=t,this.array[e+1]=i,this}setXYZ(e,t,i,r){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),i=this._normalize(i),r=this._normalize(r)),this.array[e+0]=t,this.array[e+1]=i,this.array[e+2]=r,this}setXYZW(e,t,i,r,s){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),i=this._normalize(i),r=this._normalize(r),s=this._normalize(s)),this.array[e+0]=t,this.array[e+1]=i,this.array[e+2]=r,this.array[e+3]=s,this}onUpload(e){return this.onUploadCallback=e,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){const e={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return e.name=this.name,e.usage=this.usage,e.gpuType=this.gpuType,e}dispose(){this.dispatchEvent({type:"dispose"})}_denormalize(e){const t=this._normalizationScale;return t!==void 0?Math.max(e/t,-1):u_(e,this.array)}_normalize(e){const t=this._normalizationScale;return t!==void 0?Math.round(e*t):f_(e,this.array)}}class Zd extends Ht{constructor(e,t,i){super(new Uint16Array(e),t,i)}}class Jd extends Ht{constructor(e,t,i){super(new Uint32Array(e),t,i)}}class Fn extends Ht{constructor(e,t,i){super(new Float32Array(e),t,i)}}const T_=new nn,Xs=new N,jc=new N;class eo{constructor(e=new N,t=-1){this.isSphere=!0,this.center=e,this.radius=t}set(e,t){return this.center.copy(e),this.radius=t,this}setFromPoints(e,t){const i=this.center;t!==void 0?i.copy(t):T_.setFromPoints(e).getCenter(i);let r=0;for(let s=0,a=e.length;s<a;s++)r=Math.max(r,i.distanceToSquared(e[s]));return this.radius=Math.sqrt(r),this}copy(e){return this.center.copy(e.center),this.radius=e.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(e){return e.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(e){return e.distanceTo(this.center)-this.radius}intersectsSphere(e){const t=this.radius+e.radius;return e.center.distanceToSquared(this.center)<=t*t}intersectsBox(e){return e.intersectsSphere(this)}intersectsPlane(e){return Math.abs(e.distanceToPoint(this.center))<=this.radius}clampPoint(e,t){const i=this.center.distanceToSquared(e);return t.copy(e),i>this.radius*this.radius&&(t.sub(this.center).normalize(),t.multiplyScalar(this.radius).add(this.center)),t}getBoundingBox(e){return this.isEmpty()?(e.makeEmpty(),e):(e.set(this.center,this.center),e.expandByScalar(this.radius),e)}applyMatrix4(e){return this.center.applyMatrix4(e),this.radius=this.radius*e.getMaxScaleOnAxis(),this}translate(e){return this.center.add(e),this}expandByPoint(e){if(this.isEmpty())return this.center.copy(e),this.radius=0,this;Xs.subVectors(e,this.center);const t=Xs.lengthSq();if(t>this.radius*this.radius){const i=Math.sqrt(t),r=(i-this.radius)*.5;this.center.addScaledVector(Xs,r/i),this.radius+=r}return this}union(e){return e.isEmpty()?this:this.isEmpty()?(this.copy(e),this):(this.center.equals(e.center)===!0?this.radius=Math.max(this.radius,e.radius):(jc.subVectors(e.center,this.center).setLength(e.radius),this.expandByPoint(Xs.copy(e.center).add(jc)),this.expandByPoint(Xs.copy(e.center).sub(jc))),this)}equals(e){return e.center.equals(this.center)&&e.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(e){return this.radius=e.radius,this.center.fromArray(e.center),this}}let A_=0;const Mn=new tt,eu=new ln,ts=new N,dn=new nn,qs=new nn,It=new N;class Xn extends pr{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:A_++}),this.uuid=Vs(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(e){return Array.isArray(e)?this.index=new(r_(e)?Jd:Zd)(e,1):this.index=e,this}setIndirect(e,t=0){return this.indirect=e,this.indirectOffset=t,this}getIndirect(){return this.indirect}getAttribute(e){return this.attributes[e]}setAttribute(e,t){return this.attributes[e]=t,this}deleteAttribute(e){return delete this.attributes[e],this}hasAttribute(e){return this.attributes[e]!==void 0}addGroup(e,t,i=0){this.groups.push({start:e,count:t,materialIndex:i})}clearGroups(){this.groups=[]}setDrawRange(e,t){this.drawRange.start=e,this.drawRange.count=t}applyMatrix4(e){const t=this.attributes.position;t!==void 0&&(t.applyMatrix4(e),t.needsUpdate=!0);const i=this.attributes.normal;if(i!==void 0){const s=new Fe().getNormalMatrix(e);i.applyNormalMatrix(s),i.needsUpdate=!0}const r=this.attributes.tangent;return r!==void 0&&(r.transformDirection(e),r.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(e){return Mn.makeRotationFromQuaternion(e),this.applyMatrix4(Mn),this}rotateX(e){return Mn.makeRotationX(e),this.applyMatrix4(Mn),this}rotateY(e){return Mn.makeRotationY(e),this.applyMatrix4(Mn),this}rotateZ(e){return Mn.makeRotationZ(e),this.applyMatrix4(Mn),this}translate(e,t,i){return Mn.makeTranslation(e,t,i),this.applyMatrix4(Mn),this}scale(e,t,i){return Mn.makeScale(e,t,i),this.applyMatrix4(Mn),this}lookAt(e){return eu.lookAt(e),eu.updateMatrix(),this.applyMatrix4(eu.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(ts).negate(),this.translate(ts.x,ts.y,ts.z),this}setFromPoints(e){const t=this.getAttribute("position");if(t===void 0){const i=[];for(let r=0,s=e.length;r<s;r++){const a=e[r];i.push(a.x,a.y,a.z||0)}this.setAttribute("position",new Fn(i,3))}else{const i=Math.min(e.length,t.count);for(let r=0;r<i;r++){const s=e[r];t.setXYZ(r,s.x,s.y,s.z||0)}e.length>t.count&&Le("BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),t.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new nn);const e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute){Qe("BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new N(-1/0,-1/0,-1/0),new N(1/0,1/0,1/0));return}if(e!==void 0){if(this.boundingBox.setFromBufferAttribute(e),t)for(let i=0,r=t.length;i<r;i++){const s=t[i];dn.setFromBufferAttribute(s),this.morphTargetsRelative?(It.addVectors(this.boundingBox.min,dn.min),this.boundingBox.expandByPoint(It),It.addVectors(this.boundingBox.max,dn.max),this.boundingBox.expandByPoint(It)):(this.boundingBox.expandByPoint(dn.min),this.boundingBox.expandByPoint(dn.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&Qe('BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new eo);const e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute){Qe("BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new N,1/0);return}if(e){const i=this.boundingSphere.center;if(dn.setFromBufferAttribute(e),t)for(let s=0,a=t.length;s<a;s++){const o=t[s];qs.setFromBufferAttribute(o),this.morphTargetsRelative?(It.addVectors(dn.min,qs.min),dn.expandByPoint(It),It.addVectors(dn.max,qs.max),dn.expandByPoint(It)):(dn.expandByPoint(qs.min),dn.expandByPoint(qs.max))}dn.getCenter(i);let r=0;for(let s=0,a=e.count;s<a;s++)It.fromBufferAttribute(e,s),r=Math.max(r,i.distanceToSquared(It));if(t)for(let s=0,a=t.length;s<a;s++){const o=t[s],l=this.morphTargetsRelative;for(let c=0,f=o.count;c<f;c++)It.fromBufferAttribute(o,c),l&&(ts.fromBufferAttribute(e,c),It.add(ts)),r=Math.max(r,i.distanceToSquared(It))}this.boundingSphere.radius=Math.sqrt(r),isNaN(this.boundingSphere.radius)&&Qe('BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){const e=this.index,t=this.attributes;if(e===null||t.position===void 0||t.normal===void 0||t.uv===void 0){Qe("BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}const i=t.position,r=t.normal,s=t.uv;let a=this.getAttribute("tangent");(a===void 0||a.count!==i.count)&&(a=new Ht(new Float32Array(4*i.count),4),this.setAttribute("tangent",a));const o=[],l=[],c=new Uint8Array(i.count);for(let I=0;I<i.count;I++)o[I]=new N,l[I]=new N;const f=new N,d=new N,u=new N,h=new We,g=new We,x=new We,m=new N,p=new N;function v(I,R,P){c[I]=c[R]=c[P]=1,f.fromBufferAttribute(i,I),d.fromBufferAttribute(i,R),u.fromBufferAttribute(i,P),h.fromBufferAttribute(s,I),g.fromBufferAttribute(s,R),x.fromBufferAttribute(s,P),d.sub(f),u.sub(f),g.sub(h),x.sub(h);const D=1/(g.x*x.y-x.x*g.y);isFinite(D)&&(m.copy(d).multiplyScalar(x.y).addScaledVector(u,-g.y).multiplyScalar(D),p.copy(u).multiplyScalar(g.x).addScaledVector(d,-x.x).multiplyScalar(D),o[I].add(m),o[R].add(m),o[P].add(m),l[I].add(p),l[R].add(p),l[P].add(p))}let y=this.groups;y.length===0&&(y=[{start:0,count:e.count}]);for(let I=0,R=y.length;I<R;++I){const P=y[I],D=P.start,O=P.count;for(let L=D,k=D+O;L<k;L+=3)v(e.getX(L+0),e.getX(L+1),e.getX(L+2))}const S=new N,E=new N,A=new N,_=new N;function b(I){A.fromBufferAttribute(r,I),_.copy(A);const R=o[I];S.copy(R),S.sub(A.multiplyScalar(A.dot(R))).normalize(),E.crossVectors(_,R);const D=E.dot(l[I])<0?-1:1;a.setXYZW(I,S.x,S.y,S.z,D)}for(let I=0,R=i.count;I<R;++I)c[I]&&b(I);this._transformed=!0}computeVertexNormals(){const e=this.index,t=this.getAttribute("position");if(t!==void 0){let i=this.getAttribute("normal");if(i===void 0||i.count!==t.count)i=new Ht(new Float32Array(t.count*3),3),this.setAttribute("normal",i);else for(let u=0,h=i.count;u<h;u++)i.setXYZ(u,0,0,0);const r=new N,s=new N,a=new N,o=new N,l=new N,c=new N,f=new N,d=new N;if(e)for(let u=0,h=e.count;u<h;u+=3){const g=e.getX(u+0),x=e.getX(u+1),m=e.getX(u+2);r.fromBufferAttribute(t,g),s.fromBufferAttribute(t,x),a.fromBufferAttribute(t,m),f.subVectors(a,s),d.subVectors(r,s),f.cross(d),o.fromBufferAttribute(i,g),l.fromBufferAttribute(i,x),c.fromBufferAttribute(i,m),o.add(f),l.add(f),c.add(f),i.setXYZ(g,o.x,o.y,o.z),i.setXYZ(x,l.x,l.y,l.z),i.setXYZ(m,c.x,c.y,c.z)}else for(let u=0,h=t.count;u<h;u+=3)r.fromBufferAttribute(t,u+0),s.fromBufferAttribute(t,u+1),a.fromBufferAttribute(t,u+2),f.subVectors(a,s),d.subVectors(r,s),f.cross(d),i.setXYZ(u+0,f.x,f.y,f.z),i.setXYZ(u+1,f.x,f.y,f.z),i.setXYZ(u+2,f.x,f.y,f.z);this.normalizeNormals(),i.needsUpdate=!0}}normalizeNormals(){const e=this.attributes.normal;for(let t=0,i=e.count;t<i;t++)It.fromBufferAttribute(e,t),It.normalize(),e.setXYZ(t,It.x,It.y,It.z)}toNonIndexed(){function e(o,l){const c=o.array,f=o.itemSize,d=o.normalized,u=new c.constructor(l.length*f);let h=0,g=0;for(let x=0,m=l.length;x<m;x++){o.isInterleavedBufferAttribute?h=l[x]*o.data.stride+o.offset:h=l[x]*f;for(let p=0;p<f;p++)u[g++]=c[h++]}return new Ht(u,f,d)}if(this.index===null)return Le("BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;const t=new Xn,i=this.index.array,r=this.attributes;for(const o in r){const l=r[o],c=e(l,i);t.setAttribute(o,c)}const s=this.morphAttributes;for(const o in s){const l=[],c=s[o];for(let f=0,d=c.length;f<d;f++){const u=c[f],h=e(u,i);l.push(h)}t.morphAttributes[o]=l}t.morphTargetsRelative=this.morphTargetsRelative;const a=this.groups;for(let o=0,l=a.length;o<l;o++){const c=a[o];t.addGroup(c.start,c.count,c.materialIndex)}return t}toJSON(){const e={metadata:{version:4.7,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(e.uuid=this.uuid,e.type=this.parameters!==void 0&&this._transformed===!0?"BufferGeometry":this.type,e.name=this.name,Object.keys(this.userData).length>0&&(e.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){const l=this.parameters;for(const c in l)l[c]!==void 0&&(e[c]=l[c]);return e}e.data={attributes:{}};const t=this.index;t!==null&&(e.data.index={type:t.array.constructor.name,array:Array.prototype.slice.call(t.array)});const i=this.attributes;for(const l in i){const c=i[l];e.data.attributes[l]=c.toJSON(e.data)}const r={};let s=!1;for(const l in this.morphAttributes){const c=this.morphAttributes[l],f=[];for(let d=0,u=c.length;d<u;d++){const h=c[d];f.push(h.toJSON(e.data))}f.length>0&&(r[l]=f,s=!0)}s&&(e.data.morphAttributes=r,e.data.morphTargetsRelative=this.morphTargetsRelative);const a=this.groups;a.length>0&&(e.data.groups=JSON.parse(JSON.stringify(a)));const o=this.boundingSphere;return o!==null&&(e.data.boundingSphere=o.toJSON()),e}clone(){return new this.constructor().copy(this)}copy(e){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;const t={};this.name=e.name;const i=e.index;i!==null&&this.setIndex(i.clone());const r=e.attributes;for(const c in r){const f=r[c];this.setAttribute(c,f.clone(t))}const s=e.morphAttributes;for(const c in s){const f=[],d=s[c];for(let u=0,h=d.length;u<h;u++)f.push(d[u].clone(t));this.morphAttributes[c]=f}this.morphTargetsRelative=e.morphTargetsRelative;const a=e.groups;for(let c=0,f=a.length;c<f;c++){const d=a[c];this.addGroup(d.start,d.count,d.materialIndex)}const o=e.boundingBox;o!==null&&(this.boundingBox=o.clone());const l=e.boundingSphere;return l!==null&&(this.boundingSphere=l.clone()),this.drawRange.start=e.drawRange.start,this.drawRange.count=e.drawRange.count,this.userData=e.userData,this._transformed=e._transformed,this}dispose(){this.dispatchEvent({type:"dispose"})}}const tu=new N,R_=new N,C_=new Fe;class qn{constructor(e=new N(1,0,0),t=0){this.isPlane=!0,this.normal=e,this.constant=t}set(e,t){return this.normal.copy(e),this.constant=t,this}setComponents(e,t,i,r){return this.normal.set(e,t,i),this.constant=r,this}setFromNormalAndCoplanarPoint(e,t){return this.normal.copy(e),this.constant=-t.dot(this.normal),this}setFromCoplanarPoints(e,t,i){const r=tu.subVectors(i,t).cross(R_.subVectors(e,t)).normalize();return this.setFromNormalAndCoplanarPoint(r,e),this}copy(e){return this.normal.copy(e.normal),this.constant=e.constant,this}normalize(){const e=1/this.normal.length();return this.normal.multiplyScalar(e),this.constant*=e,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(e){return this.normal.dot(e)+this.constant}distanceToSphere(e){return this.distanceToPoint(e.center)-e.radius}projectPoint(e,t){return t.copy(e).addScaledVector(this.normal,-this.distanceToPoint(e))}intersectLine(e,t,i=!0){const r=e.delta(tu),s=this.normal.dot(r);if(s===0)return this.distanceToPoint(e.start)===0?t.copy(e.start):null;const a=-(e.start.dot(this.normal)+this.constant)/s;return i===!0&&(a<0||a>1)?null:t.copy(e.start).addScaledVector(r,a)}intersectsLine(e){const t=this.distanceToPoint(e.start),i=this.distanceToPoint(e.end);return t<0&&i>0||i<0&&t>0}intersectsBox(e){return e.intersectsPlane(this)}intersectsSphere(e){return e.intersectsPlane(this)}coplanarPoint(e){return e.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(e,t){const i=t||C_.getNormalMatrix(e),r=this.coplanarPoint(tu).applyMatrix4(e),s=this.normal.applyMatrix3(i).normalize();return this.constant=-r.dot(s),this}translate(e){return this.constant-=e.dot(this.normal),this}equals(e){return e.normal.equals(this.normal)&&e.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(e){return this.normal.fromArray(e.normal),this.constant=e.constant,this}}let P_=0;class Ys extends pr{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:P_++}),this.uuid=Vs(),this.name="",this.type="Material",this.blending=ks,this.side=hi,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=ud,this.blendDst=fd,this.blendEquation=Gr,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new Je(0,0,0),this.blendAlpha=0,this.depthFunc=zs,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=Jg,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=Lc,this.stencilZFail=Lc,this.stencilZPass=Lc,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(e){this._alphaTest>0!=e>0&&this.version++,this._alphaTest=e}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(e){if(e!==void 0)for(const t in e){const i=e[t];if(i===void 0){Le(`Material: parameter '${t}' has value of undefined.`);continue}const r=this[t];if(r===void 0){Le(`Material: '${t}' is not a property of THREE.${this.type}.`);continue}r&&r.isColor?r.set(i):r&&r.isVector2&&i&&i.isVector2||r&&r.isEuler&&i&&i.isEuler||r&&r.isVector3&&i&&i.isVector3?r.copy(i):this[t]=i}}toJSON(e){const t=e===void 0||typeof e=="string";t&&(e={textures:{},images:{}});const i={metadata:{version:4.7,type:"Material",generator:"Material.toJSON"}};i.uuid=this.uuid,i.type=this.type,i.blending=this.blending,i.side=this.side,i.shadowSide=this.shadowSide,i.vertexColors=this.vertexColors,i.opacity=this.opacity,i.transparent=this.transparent,i.blendSrc=this.blendSrc,i.blendDst=this.blendDst,i.blendEquation=this.blendEquation,i.blendSrcAlpha=this.blendSrcAlpha,i.blendDstAlpha=this.blendDstAlpha,i.blendEquationAlpha=this.blendEquationAlpha,i.blendColor=this.blendColor.getHex(),i.blendAlpha=this.blendAlpha,i.depthFunc=this.depthFunc,i.depthTest=this.depthTest,i.depthWrite=this.depthWrite,i.colorWrite=this.colorWrite,i.clipIntersection=this.clipIntersection,i.clipShadows=this.clipShadows,i.stencilWriteMask=this.stencilWriteMask,i.stencilFunc=this.stencilFunc,i.stencilRef=this.stencilRef,i.stencilFuncMask=this.stencilFuncMask,i.stencilFail=this.stencilFail,i.stencilZFail=this.stencilZFail,i.stencilZPass=this.stencilZPass,i.stencilWrite=this.stencilWrite,i.polygonOffset=this.polygonOffset,i.polygonOffsetFactor=this.polygonOffsetFactor,i.polygonOffsetUnits=this.polygonOffsetUnits,i.dithering=this.dithering,i.alphaTest=this.alphaTest,i.alphaHash=this.alphaHash,i.alphaToCoverage=this.alphaToCoverage,i.premultipliedAlpha=this.premultipliedAlpha,i.forceSinglePass=this.forceSinglePass,i.allowOverride=this.allowOverride,i.visible=this.visible,i.toneMapped=this.toneMapped,i.name=this.name,this.color&&this.color.isColor&&(i.color=this.color.getHex()),this.roughness!==void 0&&(i.roughness=this.roughness),this.metalness!==void 0&&(i.metalness=this.metalness),this.sheen!==void 0&&(i.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(i.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(i.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(i.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(i.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(i.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(i.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(i.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(i.shininess=this.shininess),this.clearcoat!==void 0&&(i.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(i.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(i.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(i.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(e).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(i.clearcoatMap=this.clearcoatMap.toJSON(e).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(i.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(e).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(i.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(e).uuid,i.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(i.sheenColorMap=this.sheenColorMap.toJSON(e).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(i.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(e).uuid),this.dispersion!==void 0&&(i.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(i.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(i.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(i.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(i.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(i.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(i.iridescenceMap=this.iridescenceMap.toJSON(e).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(i.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(e).uuid),this.anisotropy!==void 0&&(i.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(i.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(i.anisotropyMap=this.anisotropyMap.toJSON(e).uuid),this.map&&this.map.isTexture&&(i.map=this.map.toJSON(e).uuid),this.matcap&&this.matcap.isTexture&&(i.matcap=this.matcap.toJSON(e).uuid),this.alphaMap&&this.alphaMap.isTexture&&(i.alphaMap=this.alphaMap.toJSON(e).uuid),this.lightMap&&this.lightMap.isTexture&&(i.lightMap=this.lightMap.toJSON(e).uuid,i.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(i.aoMap=this.aoMap.toJSON(e).uuid,i.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(i.bumpMap=this.bumpMap.toJSON(e).uuid,i.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(i.normalMap=this.normalMap.toJSON(e).uuid,i.normalMapType=this.normalMapType,i.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(i.displacementMap=this.displacementMap.toJSON(e).uuid,i.displacementScale=this.displacementScale,i.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(i.roughnessMap=this.roughnessMap.toJSON(e).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(i.metalnessMap=this.metalnessMap.toJSON(e).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(i.emissiveMap=this.emissiveMap.toJSON(e).uuid),this.specularMap&&this.specularMap.isTexture&&(i.specularMap=this.specularMap.toJSON(e).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(i.specularIntensityMap=this.specularIntensityMap.toJSON(e).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(i.specularColorMap=this.specularColorMap.toJSON(e).uuid),this.envMap&&this.envMap.isTexture&&(i.envMap=this.envMap.toJSON(e).uuid,this.combine!==void 0&&(i.combine=this.combine)),this.envMapRotation!==void 0&&(i.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(i.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(i.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(i.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(i.gradientMap=this.gradientMap.toJSON(e).uuid),this.transmission!==void 0&&(i.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(i.transmissionMap=this.transmissionMap.toJSON(e).uuid),this.thickness!==void 0&&(i.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(i.thicknessMap=this.thicknessMap.toJSON(e).uuid),this.attenuationDistance!==void 0&&(i.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(i.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(i.size=this.size),this.sizeAttenuation!==void 0&&(i.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(i.clippingPlanes=this.clippingPlanes.map(s=>s.toJSON())),this.rotation!==void 0&&(i.rotation=this.rotation),this.depthPacking!==void 0&&(i.depthPacking=this.depthPacking),this.linewidth!==void 0&&(i.linewidth=this.linewidth),this.linecap!==void 0&&(i.linecap=this.linecap),this.linejoin!==void 0&&(i.linejoin=this.linejoin),this.dashSize!==void 0&&(i.dashSize=this.dashSize),this.gapSize!==void 0&&(i.gapSize=this.gapSize),this.scale!==void 0&&(i.scale=this.scale),this.wireframe!==void 0&&(i.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(i.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(i.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(i.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(i.flatShading=this.flatShading),this.fog!==void 0&&(i.fog=this.fog),Object.keys(this.userData).length>0&&(i.userData=this.userData);function r(s){const a=[];for(const o in s){const l=s[o];delete l.metadata,a.push(l)}return a}if(t){const s=r(e.textures),a=r(e.images);s.length>0&&(i.textures=s),a.length>0&&(i.images=a)}return i}fromJSON(e,t){if(e.uuid!==void 0&&(this.uuid=e.uuid),e.name!==void 0&&(this.name=e.name),e.color!==void 0&&this.color!==void 0&&this.color.setHex(e.color),e.roughness!==void 0&&(this.roughness=e.roughness),e.metalness!==void 0&&(this.metalness=e.metalness),e.sheen!==void 0&&(this.sheen=e.sheen),e.sheenColor!==void 0&&(this.sheenColor=new Je().setHex(e.sheenColor)),e.sheenRoughness!==void 0&&(this.sheenRoughness=e.sheenRoughness),e.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(e.emissive),e.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(e.specular),e.specularIntensity!==void 0&&(this.specularIntensity=e.specularIntensity),e.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(e.specularColor),e.shininess!==void 0&&(this.shininess=e.shininess),e.clearcoat!==void 0&&(this.clearcoat=e.clearcoat),e.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=e.clearcoatRoughness),e.diffuseRoughness!==void 0&&(this.diffuseRoughness=e.diffuseRoughness),e.dispersion!==void 0&&(this.dispersion=e.dispersion),e.retroreflectivity!==void 0&&(this.retroreflectivity=e.retroreflectivity),e.iridescence!==void 0&&(this.iridescence=e.iridescence),e.iridescenceIOR!==void 0&&(this.iridescenceIOR=e.iridescenceIOR),e.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessMinimum),e.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=e.iridescenceThicknessMaximum),e.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=e.iridescenceThicknessRange[1]),e.transmission!==void 0&&(this.transmission=e.transmission),e.thickness!==void 0&&(this.thickness=e.thickness),e.attenuationDistance!==void 0&&(this.attenuationDistance=e.attenuationDistance),e.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(e.attenuationColor),e.anisotropy!==void 0&&(this.anisotropy=e.anisotropy),e.anisotropyRotation!==void 0&&(this.anisotropyRotation=e.anisotropyRotation),e.fog!==void 0&&(this.fog=e.fog),e.flatShading!==void 0&&(this.flatShading=e.flatShading),e.blending!==void 0&&(this.blending=e.blending),e.combine!==void 0&&(this.combine=e.combine),e.side!==void 0&&(this.side=e.side),e.shadowSide!==void 0&&(this.shadowSide=e.shadowSide),e.opacity!==void 0&&(this.opacity=e.opacity),e.transparent!==void 0&&(this.transparent=e.transparent),e.alphaTest!==void 0&&(this.alphaTest=e.alphaTest),e.alphaHash!==void 0&&(this.alphaHash=e.alphaHash),e.depthFunc!==void 0&&(this.depthFunc=e.depthFunc),e.depthTest!==void 0&&(this.depthTest=e.depthTest),e.depthWrite!==void 0&&(this.depthWrite=e.depthWrite),e.colorWrite!==void 0&&(this.colorWrite=e.colorWrite),e.clippingPlanes!==void 0&&(this.clippingPlanes=e.clippingPlanes.map(i=>new qn().fromJSON(i))),e.clipIntersection!==void 0&&(this.clipIntersection=e.clipIntersection),e.clipShadows!==void 0&&(this.clipShadows=e.clipShadows),e.depthPacking!==void 0&&(this.depthPacking=e.depthPacking),e.blendSrc!==void 0&&(this.blendSrc=e.blendSrc),e.blendDst!==void 0&&(this.blendDst=e.blendDst),e.blendEquation!==void 0&&(this.blendEquation=e.blendEquation),e.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=e.blendSrcAlpha),e.blendDstAlpha!==void 0&&(this.blendDstAlpha=e.blendDstAlpha),e.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=e.blendEquationAlpha),e.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(e.blendColor),e.blendAlpha!==void 0&&(this.blendAlpha=e.blendAlpha),e.stencilWriteMask!==void 0&&(this.stencilWriteMask=e.stencilWriteMask),e.stencilFunc!==void 0&&(this.stencilFunc=e.stencilFunc),e.stencilRef!==void 0&&(this.stencilRef=e.stencilRef),e.stencilFuncMask!==void 0&&(this.stencilFuncMask=e.stencilFuncMask),e.stencilFail!==void 0&&(this.stencilFail=e.stencilFail),e.stencilZFail!==void 0&&(this.stencilZFail=e.stencilZFail),e.stencilZPass!==void 0&&(this.stencilZPass=e.stencilZPass),e.stencilWrite!==void 0&&(this.stencilWrite=e.stencilWrite),e.wireframe!==void 0&&(this.wireframe=e.wireframe),e.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=e.wireframeLinewidth),e.wireframeLinecap!==void 0&&(this.wireframeLinecap=e.wireframeLinecap),e.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=e.wireframeLinejoin),e.rotation!==void 0&&(this.rotation=e.rotation),e.linewidth!==void 0&&(this.linewidth=e.linewidth),e.linecap!==void 0&&(this.linecap=e.linecap),e.linejoin!==void 0&&(this.linejoin=e.linejoin),e.dashSize!==void 0&&(this.dashSize=e.dashSize),e.gapSize!==void 0&&(this.gapSize=e.gapSize),e.scale!==void 0&&(this.scale=e.scale),e.polygonOffset!==void 0&&(this.polygonOffset=e.polygonOffset),e.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=e.polygonOffsetFactor),e.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=e.polygonOffsetUnits),e.dithering!==void 0&&(this.dithering=e.dithering),e.alphaToCoverage!==void 0&&(this.alphaToCoverage=e.alphaToCoverage),e.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=e.premultipliedAlpha),e.forceSinglePass!==void 0&&(this.forceSinglePass=e.forceSinglePass),e.allowOverride!==void 0&&(this.allowOverride=e.allowOverride),e.visible!==void 0&&(this.visible=e.visible),e.toneMapped!==void 0&&(this.toneMapped=e.toneMapped),e.userData!==void 0&&(this.userData=e.userData),e.vertexColors!==void 0&&(typeof e.vertexColors=="number"?this.vertexColors=e.vertexColors>0:this.vertexColors=e.vertexColors),e.size!==void 0&&(this.size=e.size),e.sizeAttenuation!==void 0&&(this.sizeAttenuation=e.sizeAttenuation),e.map!==void 0&&(this.map=t[e.map]||null),e.matcap!==void 0&&(this.matcap=t[e.matcap]||null),e.alphaMap!==void 0&&(this.alphaMap=t[e.alphaMap]||null),e.bumpMap!==void 0&&(this.bumpMap=t[e.bumpMap]||null),e.bumpScale!==void 0&&(this.bumpScale=e.bumpScale),e.normalMap!==void 0&&(this.normalMap=t[e.normalMap]||null),e.normalMapType!==void 0&&(this.normalMapType=e.normalMapType),e.normalScale!==void 0){let i=e.normalScale;Array.isArray(i)===!1&&(i=[i,i]),this.normalScale=new We().fromArray(i)}return e.displacementMap!==void 0&&(this.displacementMap=t[e.displacementMap]||null),e.displacementScale!==void 0&&(this.displacementScale=e.displacementScale),e.displacementBias!==void 0&&(this.displacementBias=e.displacementBias),e.roughnessMap!==void 0&&(this.roughnessMap=t[e.roughnessMap]||null),e.metalnessMap!==void 0&&(this.metalnessMap=t[e.metalnessMap]||null),e.emissiveMap!==void 0&&(this.emissiveMap=t[e.emissiveMap]||null),e.emissiveIntensity!==void 0&&(this.emissiveIntensity=e.emissiveIntensity),e.specularMap!==void 0&&(this.specularMap=t[e.specularMap]||null),e.specularIntensityMap!==void 0&&(this.specularIntensityMap=t[e.specularIntensityMap]||null),e.specularColorMap!==void 0&&(this.specularColorMap=t[e.specularColorMap]||null),e.envMap!==void 0&&(this.envMap=t[e.envMap]||null),e.envMapRotation!==void 0&&this.envMapRotation.fromArray(e.envMapRotation),e.envMapIntensity!==void 0&&(this.envMapIntensity=e.envMapIntensity),e.reflectivity!==void 0&&(this.reflectivity=e.reflectivity),e.refractionRatio!==void 0&&(this.refractionRatio=e.refractionRatio),e.lightMap!==void 0&&(this.lightMap=t[e.lightMap]||null),e.lightMapIntensity!==void 0&&(this.lightMapIntensity=e.lightMapIntensity),e.aoMap!==void 0&&(this.aoMap=t[e.aoMap]||null),e.aoMapIntensity!==void 0&&(this.aoMapIntensity=e.aoMapIntensity),e.gradientMap!==void 0&&(this.gradientMap=t[e.gradientMap]||null),e.clearcoatMap!==void 0&&(this.clearcoatMap=t[e.clearcoatMap]||null),e.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=t[e.clearcoatRoughnessMap]||null),e.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=t[e.clearcoatNormalMap]||null),e.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new We().fromArray(e.clearcoatNormalScale)),e.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=t[e.diffuseRoughnessMap]||null),e.iridescenceMap!==void 0&&(this.iridescenceMap=t[e.iridescenceMap]||null),e.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=t[e.iridescenceThicknessMap]||null),e.transmissionMap!==void 0&&(this.transmissionMap=t[e.transmissionMap]||null),e.thicknessMap!==void 0&&(this.thicknessMap=t[e.thicknessMap]||null),e.anisotropyMap!==void 0&&(this.anisotropyMap=t[e.anisotropyMap]||null),e.sheenColorMap!==void 0&&(this.sheenColorMap=t[e.sheenColorMap]||null),e.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=t[e.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(e){this.name=e.name,this.blending=e.blending,this.side=e.side,this.vertexColors=e.vertexColors,this.opacity=e.opacity,this.transparent=e.transparent,this.blendSrc=e.blendSrc,this.blendDst=e.blendDst,this.blendEquation=e.blendEquation,this.blendSrcAlpha=e.blendSrcAlpha,this.blendDstAlpha=e.blendDstAlpha,this.blendEquationAlpha=e.blendEquationAlpha,this.blendColor.copy(e.blendColor),this.blendAlpha=e.blendAlpha,this.depthFunc=e.depthFunc,this.depthTest=e.depthTest,this.depthWrite=e.depthWrite,this.stencilWriteMask=e.stencilWriteMask,this.stencilFunc=e.stencilFunc,this.stencilRef=e.stencilRef,this.stencilFuncMask=e.stencilFuncMask,this.stencilFail=e.stencilFail,this.stencilZFail=e.stencilZFail,this.stencilZPass=e.stencilZPass,this.stencilWrite=e.stencilWrite;const t=e.clippingPlanes;let i=null;if(t!==null){const r=t.length;i=new Array(r);for(let s=0;s!==r;++s)i[s]=t[s].clone()}return this.clippingPlanes=i,this.clipIntersection=e.clipIntersection,this.clipShadows=e.clipShadows,this.shadowSide=e.shadowSide,this.colorWrite=e.colorWrite,this.precision=e.precision,this.polygonOffset=e.polygonOffset,this.polygonOffsetFactor=e.polygonOffsetFactor,this.polygonOffsetUnits=e.polygonOffsetUnits,this.dithering=e.dithering,this.alphaTest=e.alphaTest,this.alphaHash=e.alphaHash,this.alphaToCoverage=e.alphaToCoverage,this.premultipliedAlpha=e.premultipliedAlpha,this.forceSinglePass=e.forceSinglePass,this.allowOverride=e.allowOverride,this.visible=e.visible,this.toneMapped=e.toneMapped,this.userData=JSON.parse(JSON.stringify(e.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(e){e===!0&&this.version++}}const Mi=new N,nu=new N,to=new N,no=new N;class io{constructor(e=new N,t=new N(0,0,-1)){this.origin=e,this.direction=t}set(e,t){return this.origin.copy(e),this.direction.copy(t),this}copy(e){return this.origin.copy(e.origin),this.direction.copy(e.direction),this}at(e,t){return t.copy(this.origin).addScaledVector(this.direction,e)}lookAt(e){return this.direction.copy(e).sub(this.origin).normalize(),this}recast(e){return this.origin.copy(this.at(e,Mi)),this}closestPointToPoint(e,t){t.subVectors(e,this.origin);const i=t.dot(this.direction);return i<0?t.copy(this.origin):t.copy(this.origin).addScaledVector(this.direction,i)}distanceToPoint(e){return Math.sqrt(this.distanceSqToPoint(e))}distanceSqToPoint(e){const t=Mi.subVectors(e,this.origin).dot(this.direction);return t<0?this.origin.distanceToSquared(e):(Mi.copy(this.origin).addScaledVector(this.direction,t),Mi.distanceToSquared(e))}distanceSqToSegment(e,t,i,r){nu.copy(e).add(t).multiplyScalar(.5),to.copy(t).sub(e).normalize(),no.copy(this.origin).sub(nu);const s=e.distanceTo(t)*.5,a=-this.direction.dot(to),o=no.dot(this.direction),l=-no.dot(to),c=no.lengthSq(),f=Math.abs(1-a*a);let d,u,h,g;if(f>0)if(d=a*l-o,u=a*o-l,g=s*f,d>=0)if(u>=-g)if(u<=g){const x=1/f;d*=x,u*=x,h=d*(d+a*u+2*o)+u*(a*d+u+2*l)+c}else u=s,d=Math.max(0,-(a*u+o)),h=-d*d+u*(u+2*l)+c;else u=-s,d=Math.max(0,-(a*u+o)),h=-d*d+u*(u+2*l)+c;else u<=-g?(d=Math.max(0,-(-a*s+o)),u=d>0?-s:Math.min(Math.max(-s,-l),s),h=-d*d+u*(u+2*l)+c):u<=g?(d=0,u=Math.min(Math.max(-s,-l),s),h=u*(u+2*l)+c):(d=Math.max(0,-(a*s+o)),u=d>0?s:Math.min(Math.max(-s,-l),s),h=-d*d+u*(u+2*l)+c);else u=a>0?-s:s,d=Math.max(0,-(a*u+o)),h=-d*d+u*(u+2*l)+c;return i&&i.copy(this.origin).addScaledVector(this.direction,d),r&&r.copy(nu).addScaledVector(to,u),h}intersectSphere(e,t){if(e.radius<0)return null;Mi.subVectors(e.center,this.origin);const i=Mi.dot(this.direction),r=Mi.dot(Mi)-i*i,s=e.radius*e.radius;if(r>s)return null;const a=Math.sqrt(s-r),o=i-a,l=i+a;return l<0?null:o<0?this.at(l,t):this.at(o,t)}intersectsSphere(e){return e.radius<0?!1:this.distanceSqToPoint(e.center)<=e.radius*e.radius}distanceToPlane(e){const t=e.normal.dot(this.direction);if(t===0)return e.distanceToPoint(this.origin)===0?0:null;const i=-(this.origin.dot(e.normal)+e.constant)/t;return i>=0?i:null}intersectPlane(e,t){const i=this.distanceToPlane(e);return i===null?null:this.at(i,t)}intersectsPlane(e){const t=e.distanceToPoint(this.origin);return t===0||e.normal.dot(this.direction)*t<0}intersectBox(e,t){let i,r,s,a,o,l;const c=1/this.direction.x,f=1/this.direction.y,d=1/this.direction.z,u=this.origin;return c>=0?(i=(e.min.x-u.x)*c,r=(e.max.x-u.x)*c):(i=(e.max.x-u.x)*c,r=(e.min.x-u.x)*c),f>=0?(s=(e.min.y-u.y)*f,a=(e.max.y-u.y)*f):(s=(e.max.y-u.y)*f,a=(e.min.y-u.y)*f),i>a||s>r||((s>i||isNaN(i))&&(i=s),(a<r||isNaN(r))&&(r=a),d>=0?(o=(e.min.z-u.z)*d,l=(e.max.z-u.z)*d):(o=(e.max.z-u.z)*d,l=(e.min.z-u.z)*d),i>l||o>r)||((o>i||i!==i)&&(i=o),(l<r||r!==r)&&(r=l),r<0)?null:this.at(i>=0?i:r,t)}intersectsBox(e){return this.intersectBox(e,Mi)!==null}intersectTriangle(e,t,i,r,s){const a=this.origin,o=this.direction,l=o.x,c=o.y,f=o.z,d=e.x-a.x,u=e.y-a.y,h=e.z-a.z,g=t.x-a.x,x=t.y-a.y,m=t.z-a.z,p=i.x-a.x,v=i.y-a.y,y=i.z-a.z,S=Math.abs(l),E=Math.abs(c),A=Math.abs(f);let _,b,I,R,P,D,O,L,k,V,W,te;if(S>=E&&S>=A?(I=l,D=d,k=g,te=p,l>=0?(_=c,b=f,R=u,P=h,O=x,L=m,V=v,W=y):(_=f,b=c,R=h,P=u,O=m,L=x,V=y,W=v)):E>=A?(I=c,D=u,k=x,te=v,c>=0?(_=f,b=l,R=h,P=d,O=m,L=g,V=y,W=p):(_=l,b=f,R=d,P=h,O=g,L=m,V=p,W=y)):(I=f,D=h,k=m,te=y,f>=0?(_=l,b=c,R=d,P=u,O=g,L=x,V=p,W=v):(_=c,b=l,R=u,P=d,O=x,L=g,V=v,W=p)),I===0)return null;const X=_/I,j=b/I,ee=1/I,Se=R-X*D,De=P-j*D,Z=O-X*k,fe=L-j*k,xe=V-X*te,Ae=W-j*te,ge=xe*fe-Ae*Z,Ie=Se*Ae-De*xe,_t=Z*De-fe*Se;if(r){if(ge<0||Ie<0||_t<0)return null}else if((ge<0||Ie<0||_t<0)&&(ge>0||Ie>0||_t>0))return null;const Re=ge+Ie+_t;if(Re===0)return null;const Ke=ee*(ge*D+Ie*k+_t*te);return(Re>0?Ke<0:Ke>0)?null:this.at(Ke/Re,s)}applyMatrix4(e){return this.origin.applyMatrix4(e),this.direction.transformDirection(e),this}equals(e){return e.origin.equals(this.origin)&&e.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}}class L_ extends Ys{constructor(e){super(),this.isMeshBasicMaterial=!0,this.type="MeshBasicMaterial",this.color=new Je(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new mr,this.combine=dd,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.lightMap=e.lightMap,this.lightMapIntensity=e.lightMapIntensity,this.aoMap=e.aoMap,this.aoMapIntensity=e.aoMapIntensity,this.specularMap=e.specularMap,this.alphaMap=e.alphaMap,this.envMap=e.envMap,this.envMapRotation.copy(e.envMapRotation),this.combine=e.combine,this.reflectivity=e.reflectivity,this.refractionRatio=e.refractionRatio,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.wireframeLinecap=e.wireframeLinecap,this.wireframeLinejoin=e.wireframeLinejoin,this.fog=e.fog,this}}const Qd=new tt,vr=new io,ro=new eo,jd=new N,so=new N,ao=new N,oo=new N,iu=new N,lo=new N,eh=new N,co=new N;class yi extends ln{constructor(e=new Xn,t=new L_){super(),this.isMesh=!0,this.type="Mesh",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}updateMorphTargets(){const t=this.geometry.morphAttributes,i=Object.keys(t);if(i.length>0){const r=t[i[0]];if(r!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let s=0,a=r.length;s<a;s++){const o=r[s].name||String(s);this.morphTargetInfluences.push(0),this.morphTargetDictionary[o]=s}}}}getVertexPosition(e,t){const i=this.geometry,r=i.attributes.position,s=i.morphAttributes.position,a=i.morphTargetsRelative;t.fromBufferAttribute(r,e);const o=this.morphTargetInfluences;if(s&&o){lo.set(0,0,0);for(let l=0,c=s.length;l<c;l++){const f=o[l],d=s[l];f!==0&&(iu.fromBufferAttribute(d,e),a?lo.addScaledVector(iu,f):lo.addScaledVector(iu.sub(t),f))}t.add(lo)}return t}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){const i=this.geometry,r=this.material,s=this.matrixWorld;r!==void 0&&(i.boundingSphere===null&&i.computeBoundingSphere(),ro.copy(i.boundingSphere),ro.applyMatrix4(s),vr.copy(e.ray).recast(e.near),!(ro.containsPoint(vr.origin)===!1&&(vr.intersectSphere(ro,jd)===null||vr.origin.distanceToSquared(jd)>(e.far-e.near)**2))&&(Qd.copy(s).invert(),vr.copy(e.ray).applyMatrix4(Qd),!(i.boundingBox!==null&&vr.intersectsBox(i.boundingBox)===!1)&&this._computeIntersections(e,t,vr)))}_computeIntersections(e,t,i){let r;const s=this.geometry,a=this.material,o=s.index,l=s.attributes.position,c=s.attributes.uv,f=s.attributes.uv1,d=s.attributes.normal,u=s.groups,h=s.drawRange;if(o!==null)if(Array.isArray(a))for(let g=0,x=u.length;g<x;g++){const m=u[g],p=a[m.materialIndex],v=Math.max(m.start,h.start),y=Math.min(o.count,Math.min(m.start+m.count,h.start+h.count));for(let S=v,E=y;S<E;S+=3){const A=o.getX(S),_=o.getX(S+1),b=o.getX(S+2);r=uo(this,p,e,i,c,f,d,A,_,b),r&&(r.faceIndex=Math.floor(S/3),r.face.materialIndex=m.materialIndex,t.push(r))}}else{const g=Math.max(0,h.start),x=Math.min(o.count,h.start+h.count);for(let m=g,p=x;m<p;m+=3){const v=o.getX(m),y=o.getX(m+1),S=o.getX(m+2);r=uo(this,a,e,i,c,f,d,v,y,S),r&&(r.faceIndex=Math.floor(m/3),t.push(r))}}else if(l!==void 0)if(Array.isArray(a))for(let g=0,x=u.length;g<x;g++){const m=u[g],p=a[m.materialIndex],v=Math.max(m.start,h.start),y=Math.min(l.count,Math.min(m.start+m.count,h.start+h.count));for(let S=v,E=y;S<E;S+=3){const A=S,_=S+1,b=S+2;r=uo(this,p,e,i,c,f,d,A,_,b),r&&(r.faceIndex=Math.floor(S/3),r.face.materialIndex=m.materialIndex,t.push(r))}}else{const g=Math.max(0,h.start),x=Math.min(l.count,h.start+h.count);for(let m=g,p=x;m<p;m+=3){const v=m,y=m+1,S=m+2;r=uo(this,a,e,i,c,f,d,v,y,S),r&&(r.faceIndex=Math.floor(m/3),t.push(r))}}}}function D_(n,e,t,i,r,s,a,o){let l;if(e.side===en?l=i.intersectTriangle(a,s,r,!0,o):l=i.intersectTriangle(r,s,a,e.side===hi,o),l===null)return null;co.copy(o),co.applyMatrix4(n.matrixWorld);const c=t.ray.origin.distanceTo(co);return c<t.near||c>t.far?null:{distance:c,point:co.clone(),object:n}}function uo(n,e,t,i,r,s,a,o,l,c){n.getVertexPosition(o,so),n.getVertexPosition(l,ao),n.getVertexPosition(c,oo);const f=D_(n,e,t,i,so,ao,oo,eh);if(f){const d=new N;zt.getBarycoord(eh,so,ao,oo,d),r&&(f.uv=zt.getInterpolatedAttribute(r,o,l,c,d,new We)),s&&(f.uv1=zt.getInterpolatedAttribute(s,o,l,c,d,new We)),a&&(f.normal=zt.getInterpolatedAttribute(a,o,l,c,d,new N),f.normal.dot(i.direction)>0&&f.normal.multiplyScalar(-1));const u={a:o,b:l,c,normal:new N,materialIndex:0};zt.getNormal(so,ao,oo,u.normal),f.face=u,f.barycoord=d}return f}class I_ extends tn{constructor(e=null,t=1,i=1,r,s,a,o,l,c=kt,f=kt,d,u){super(null,a,o,l,c,f,r,s,d,u),this.isDataTexture=!0,this.image={data:e,width:t,height:i},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}}const xr=new eo,N_=new We(.5,.5),fo=new N;class ho{constructor(e=new qn,t=new qn,i=new qn,r=new qn,s=new qn,a=new qn){this.planes=[e,t,i,r,s,a]}set(e,t,i,r,s,a){const o=this.planes;return o[0].copy(e),o[1].copy(t),o[2].copy(i),o[3].copy(r),o[4].copy(s),o[5].copy(a),this}copy(e){const t=this.planes;for(let i=0;i<6;i++)t[i].copy(e.planes[i]);return this}setFromProjectionMatrix(e,t=Ln,i=!1){const r=this.planes,s=e.elements,a=s[0],o=s[1],l=s[2],c=s[3],f=s[4],d=s[5],u=s[6],h=s[7],g=s[8],x=s[9],m=s[10],p=s[11],v=s[12],y=s[13],S=s[14],E=s[15];if(r[0].setComponents(c-a,h-f,p-g,E-v).normalize(),r[1].setComponents(c+a,h+f,p+g,E+v).normalize(),r[2].setComponents(c+o,h+d,p+x,E+y).normalize(),r[3].setComponents(c-o,h-d,p-x,E-y).normalize(),i)r[4].setComponents(l,u,m,S).normalize(),r[5].setComponents(c-l,h-u,p-m,E-S).normalize();else if(r[4].setComponents(c-l,h-u,p-m,E-S).normalize(),t===Ln)r[5].setComponents(c+l,h+u,p+m,E+S).normalize();else if(t===Va)r[5].setComponents(l,u,m,S).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+t);return this}intersectsObject(e){if(e.boundingSphere!==void 0)e.boundingSphere===null&&e.computeBoundingSphere(),xr.copy(e.boundingSphere).applyMatrix4(e.matrixWorld);else{const t=e.geometry;t.boundingSphere===null&&t.computeBoundingSphere(),xr.copy(t.boundingSphere).applyMatrix4(e.matrixWorld)}return this.intersectsSphere(xr)}intersectsSprite(e){xr.center.set(0,0,0);const t=N_.distanceTo(e.center);return xr.radius=.7071067811865476+t,xr.applyMatrix4(e.matrixWorld),this.intersectsSphere(xr)}intersectsSphere(e){const t=this.planes,i=e.center,r=-e.radius;for(let s=0;s<6;s++)if(t[s].distanceToPoint(i)<r)return!1;return!0}intersectsBox(e){const t=this.planes;for(let i=0;i<6;i++){const r=t[i];if(fo.x=r.normal.x>0?e.max.x:e.min.x,fo.y=r.normal.y>0?e.max.y:e.min.y,fo.z=r.normal.z>0?e.max.z:e.min.z,r.distanceToPoint(fo)<0)return!1}return!0}containsPoint(e){const t=this.planes;for(let i=0;i<6;i++)if(t[i].distanceToPoint(e)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}}const th=new tt;class ru{constructor(){this.coordinateSystem=Ln,this._frustums=[],this._count=0}setFromArrayCamera(e){const t=e.cameras,i=this._frustums;for(let r=0;r<t.length;r++){const s=t[r];th.multiplyMatrices(s.projectionMatrix,s.matrixWorldInverse),i[r]===void 0&&(i[r]=new ho),i[r].setFromProjectionMatrix(th,s.coordinateSystem,s.reversedDepth)}return this._count=t.length,this}getFrustum(e){return this._frustums[e]}intersectsObject(e){const t=this._frustums;for(let i=0;i<this._count;i++)if(t[i].intersectsObject(e))return!0;return!1}intersectsSprite(e){const t=this._frustums;for(let i=0;i<this._count;i++)if(t[i].intersectsSprite(e))return!0;return!1}intersectsSphere(e){const t=this._frustums;for(let i=0;i<this._count;i++)if(t[i].intersectsSphere(e))return!0;return!1}intersectsBox(e){const t=this._frustums;for(let i=0;i<this._count;i++)if(t[i].intersectsBox(e))return!0;return!1}containsPoint(e){const t=this._frustums;for(let i=0;i<this._count;i++)if(t[i].containsPoint(e))return!0;return!1}copy(e){this.coordinateSystem=e.coordinateSystem;const t=this._frustums,i=e._frustums;for(let r=0;r<e._count;r++)t[r]===void 0&&(t[r]=new ho),t[r].copy(i[r]);return this._count=e._count,this}clone(){return new ru().copy(this)}}class nh extends Ys{constructor(e){super(),this.isLineBasicMaterial=!0,this.type="LineBasicMaterial",this.color=new Je(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.linewidth=e.linewidth,this.linecap=e.linecap,this.linejoin=e.linejoin,this.fog=e.fog,this}}const po=new N,mo=new N,ih=new tt,Ks=new io,go=new eo,su=new N,rh=new N;class U_ extends ln{constructor(e=new Xn,t=new nh){super(),this.isLine=!0,this.type="Line",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}computeLineDistances(){const e=this.geometry;if(e.index===null){const t=e.attributes.position,i=[0];for(let r=1,s=t.count;r<s;r++)po.fromBufferAttribute(t,r-1),mo.fromBufferAttribute(t,r),i[r]=i[r-1],i[r]+=po.distanceTo(mo);e.setAttribute("lineDistance",new Fn(i,1))}else Le("Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){const i=this.geometry,r=this.matrixWorld,s=e.params.Line.threshold,a=i.drawRange;if(i.boundingSphere===null&&i.computeBoundingSphere(),go.copy(i.boundingSphere),go.applyMatrix4(r),go.radius+=s,e.ray.intersectsSphere(go)===!1)return;ih.copy(r).invert(),Ks.copy(e.ray).applyMatrix4(ih);const o=s/((this.scale.x+this.scale.y+this.scale.z)/3),l=o*o,c=this.isLineSegments?2:1,f=i.index,u=i.attributes.position;if(f!==null){const h=Math.max(0,a.start),g=Math.min(f.count,a.start+a.count);for(let x=h,m=g-1;x<m;x+=c){const p=f.getX(x),v=f.getX(x+1),y=_o(this,e,Ks,l,p,v,x);y&&t.push(y)}if(this.isLineLoop){const x=f.getX(g-1),m=f.getX(h),p=_o(this,e,Ks,l,x,m,g-1);p&&t.push(p)}}else{const h=Math.max(0,a.start),g=Math.min(u.count,a.start+a.count);for(let x=h,m=g-1;x<m;x+=c){const p=_o(this,e,Ks,l,x,x+1,x);p&&t.push(p)}if(this.isLineLoop){const x=_o(this,e,Ks,l,g-1,h,g-1);x&&t.push(x)}}}updateMorphTargets(){const t=this.geometry.morphAttributes,i=Object.keys(t);if(i.length>0){const r=t[i[0]];if(r!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let s=0,a=r.length;s<a;s++){const o=r[s].name||String(s);this.morphTargetInfluences.push(0),this.morphTargetDictionary[o]=s}}}}}function _o(n,e,t,i,r,s,a){const o=n.geometry.attributes.position;if(po.fromBufferAttribute(o,r),mo.fromBufferAttribute(o,s),t.distanceSqToSegment(po,mo,su,rh)>i)return;su.applyMatrix4(n.matrixWorld);const c=e.ray.origin.distanceTo(su);if(!(c<e.near||c>e.far))return{distance:c,point:rh.clone().applyMatrix4(n.matrixWorld),index:a,face:null,faceIndex:null,barycoord:null,object:n}}const sh=new N,ah=new N;class F_ extends U_{constructor(e,t){super(e,t),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){const e=this.geometry;if(e.index===null){const t=e.attributes.position,i=[];for(let r=0,s=t.count;r<s;r+=2)sh.fromBufferAttribute(t,r),ah.fromBufferAttribute(t,r+1),i[r]=r===0?0:i[r-1],i[r+1]=i[r]+sh.distanceTo(ah);e.setAttribute("lineDistance",new Fn(i,1))}else Le("LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}}class oh extends tn{constructor(e=[],t=Vr,i,r,s,a,o,l,c,f){super(e,t,i,r,s,a,o,l,c,f),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(e){this.image=e}}class ns extends tn{constructor(e,t,i=Gn,r,s,a,o=kt,l=kt,c,f=Fi,d=1){if(f!==Fi&&f!==Oi)throw new Error("THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat");const u={width:e,height:t,depth:d};super(u,r,s,a,o,l,f,i,c),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(e){return super.copy(e),this.source=new kc(Object.assign({},e.image)),this.compareFunction=e.compareFunction,this}toJSON(e){const t=super.toJSON(e);return t.compareFunction=this.compareFunction,t}}class lh extends ns{constructor(e,t=Gn,i=Vr,r,s,a=kt,o=kt,l,c=Fi){const f={width:e,height:e,depth:1},d=[f,f,f,f,f,f];super(e,e,t,i,r,s,a,o,l,c),this.image=d,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(e){this.image=e}}class ch extends tn{constructor(e=null){super(),this.sourceTexture=e,this.isExternalTexture=!0}copy(e){return super.copy(e),this.sourceTexture=e.sourceTexture,this}}class Zs extends Xn{constructor(e=1,t=1,i=1,r=1,s=1,a=1){super(),this.type="BoxGeometry",this.parameters={width:e,height:t,depth:i,widthSegments:r,heightSegments:s,depthSegments:a};const o=this;r=Math.floor(r),s=Math.floor(s),a=Math.floor(a);const l=[],c=[],f=[],d=[];let u=0,h=0;g("z","y","x",-1,-1,i,t,e,a,s,0),g("z","y","x",1,-1,i,t,-e,a,s,1),g("x","z","y",1,1,e,i,t,r,a,2),g("x","z","y",1,-1,e,i,-t,r,a,3),g("x","y","z",1,-1,e,t,i,r,s,4),g("x","y","z",-1,-1,e,t,-i,r,s,5),this.setIndex(l),this.setAttribute("position",new Fn(c,3)),this.setAttribute("normal",new Fn(f,3)),this.setAttribute("uv",new Fn(d,2));function g(x,m,p,v,y,S,E,A,_,b,I){const R=S/_,P=E/b,D=S/2,O=E/2,L=A/2,k=_+1,V=b+1;let W=0,te=0;const X=new N;for(let j=0;j<V;j++){const ee=j*P-O;for(let Se=0;Se<k;Se++){const De=Se*R-D;X[x]=De*v,X[m]=ee*y,X[p]=L,c.push(X.x,X.y,X.z),X[x]=0,X[m]=0,X[p]=A>0?1:-1,f.push(X.x,X.y,X.z),d.push(Se/_),d.push(1-j/b),W+=1}}for(let j=0;j<b;j++)for(let ee=0;ee<_;ee++){const Se=u+ee+k*j,De=u+ee+k*(j+1),Z=u+(ee+1)+k*(j+1),fe=u+(ee+1)+k*j;l.push(Se,De,fe),l.push(De,Z,fe),te+=6}o.addGroup(h,te,I),h+=te,u+=W}}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new Zs(e.width,e.height,e.depth,e.widthSegments,e.heightSegments,e.depthSegments)}}class vo extends Xn{constructor(e=1,t=1,i=1,r=1){super(),this.type="PlaneGeometry",this.parameters={width:e,height:t,widthSegments:i,heightSegments:r};const s=e/2,a=t/2,o=Math.floor(i),l=Math.floor(r),c=o+1,f=l+1,d=e/o,u=t/l,h=[],g=[],x=[],m=[];for(let p=0;p<f;p++){const v=p*u-a;for(let y=0;y<c;y++){const S=y*d-s;g.push(S,-v,0),x.push(0,0,1),m.push(y/o),m.push(1-p/l)}}for(let p=0;p<l;p++)for(let v=0;v<o;v++){const y=v+c*p,S=v+c*(p+1),E=v+1+c*(p+1),A=v+1+c*p;h.push(y,S,A),h.push(S,E,A)}this.setIndex(h),this.setAttribute("position",new Fn(g,3)),this.setAttribute("normal",new Fn(x,3)),this.setAttribute("uv",new Fn(m,2))}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new vo(e.width,e.height,e.widthSegments,e.heightSegments)}}function is(n){const e={};for(const t in n){e[t]={};for(const i in n[t]){const r=n[t][i];if(uh(r))r.isRenderTargetTexture?(Le("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),e[t][i]=null):e[t][i]=r.clone();else if(Array.isArray(r))if(uh(r[0])){const s=[];for(let a=0,o=r.length;a<o;a++)s[a]=r[a].clone();e[t][i]=s}else e[t][i]=r.slice();else e[t][i]=r}}return e}function rn(n){const e={};for(let t=0;t<n.length;t++){const i=is(n[t]);for(const r in i)e[r]=i[r]}return e}function uh(n){return n&&(n.isColor||n.isMatrix3||n.isMatrix4||n.isVector2||n.isVector3||n.isVector4||n.isTexture||n.isQuaternion)}function O_(n){const e=[];for(let t=0;t<n.length;t++)e.push(n[t].clone());return e}function fh(n){const e=n.getRenderTarget();return e===null?n.outputColorSpace:e.isXRRenderTarget===!0?e.texture.colorSpace:Ye.workingColorSpace}const B_={clone:is,merge:rn};var k_=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,z_=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`;class Wi extends Ys{constructor(e){super(),this.isShaderMaterial=!0,this.type="ShaderMaterial",this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=k_,this.fragmentShader=z_,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,e!==void 0&&this.setValues(e)}copy(e){return super.copy(e),this.fragmentShader=e.fragmentShader,this.vertexShader=e.vertexShader,this.uniforms=is(e.uniforms),this.uniformsGroups=O_(e.uniformsGroups),this.defines=Object.assign({},e.defines),this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.fog=e.fog,this.lights=e.lights,this.clipping=e.clipping,this.extensions=Object.assign({},e.extensions),this.glslVersion=e.glslVersion,this.defaultAttributeValues=Object.assign({},e.defaultAttributeValues),this.index0AttributeName=e.index0AttributeName,this.uniformsNeedUpdate=e.uniformsNeedUpdate,this}toJSON(e){const t=super.toJSON(e);t.glslVersion=this.glslVersion,t.uniforms={};for(const r in this.uniforms){const a=this.uniforms[r].value;a&&a.isTexture?t.uniforms[r]={type:"t",value:a.toJSON(e).uuid}:a&&a.isColor?t.uniforms[r]={type:"c",value:a.getHex()}:a&&a.isVector2?t.uniforms[r]={type:"v2",value:a.toArray()}:a&&a.isVector3?t.uniforms[r]={type:"v3",value:a.toArray()}:a&&a.isVector4?t.uniforms[r]={type:"v4",value:a.toArray()}:a&&a.isMatrix3?t.uniforms[r]={type:"m3",value:a.toArray()}:a&&a.isMatrix4?t.uniforms[r]={type:"m4",value:a.toArray()}:t.uniforms[r]={value:a}}Object.keys(this.defines).length>0&&(t.defines=this.defines),t.vertexShader=this.vertexShader,t.fragmentShader=this.fragmentShader,t.lights=this.lights,t.clipping=this.clipping;const i={};for(const r in this.extensions)this.extensions[r]===!0&&(i[r]=!0);return Object.keys(i).length>0&&(t.extensions=i),t}fromJSON(e,t){if(super.fromJSON(e,t),e.uniforms!==void 0)for(const i in e.uniforms){const r=e.uniforms[i];switch(this.uniforms[i]={},r.type){case"t":this.uniforms[i].value=t[r.value]||null;break;case"c":this.uniforms[i].value=new Je().setHex(r.value);break;case"v2":this.uniforms[i].value=new We().fromArray(r.value);break;case"v3":this.uniforms[i].value=new N().fromArray(r.value);break;case"v4":this.uniforms[i].value=new ot().fromArray(r.value);break;case"m3":this.uniforms[i].value=new Fe().fromArray(r.value);break;case"m4":this.uniforms[i].value=new tt().fromArray(r.value);break;default:this.uniforms[i].value=r.value}}if(e.defines!==void 0&&(this.defines=e.defines),e.vertexShader!==void 0&&(this.vertexShader=e.vertexShader),e.fragmentShader!==void 0&&(this.fragmentShader=e.fragmentShader),e.glslVersion!==void 0&&(this.glslVersion=e.glslVersion),e.extensions!==void 0)for(const i in e.extensions)this.extensions[i]=e.extensions[i];return e.lights!==void 0&&(this.lights=e.lights),e.clipping!==void 0&&(this.clipping=e.clipping),this}}class H_ extends Wi{constructor(e){super(e),this.isRawShaderMaterial=!0,this.type="RawShaderMaterial"}}class G_ extends Ys{constructor(e){super(),this.isMeshDepthMaterial=!0,this.type="MeshDepthMaterial",this.depthPacking=Kg,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(e)}copy(e){return super.copy(e),this.depthPacking=e.depthPacking,this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this}}class V_ extends Ys{constructor(e){super(),this.isMeshDistanceMaterial=!0,this.type="MeshDistanceMaterial",this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(e)}copy(e){return super.copy(e),this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this}}const xo=new N,So=new ki,Yn=new N;class dh extends ln{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new tt,this.projectionMatrix=new tt,this.projectionMatrixInverse=new tt,this.coordinateSystem=Ln,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(e,t){return super.copy(e,t),this.matrixWorldInverse.copy(e.matrixWorldInverse),this.projectionMatrix.copy(e.projectionMatrix),this.projectionMatrixInverse.copy(e.projectionMatrixInverse),this.coordinateSystem=e.coordinateSystem,this}getWorldDirection(e){return super.getWorldDirection(e).negate()}updateMatrixWorld(e){super.updateMatrixWorld(e),this.matrixWorld.decompose(xo,So,Yn),Yn.x===1&&Yn.y===1&&Yn.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(xo,So,Yn.set(1,1,1)).invert()}updateWorldMatrix(e,t,i=!1){super.updateWorldMatrix(e,t,i),this.matrixWorld.decompose(xo,So,Yn),Yn.x===1&&Yn.y===1&&Yn.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(xo,So,Yn.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}}const $i=new N,hh=new We,ph=new We;class yn extends dh{constructor(e=50,t=1,i=.1,r=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=e,this.zoom=1,this.near=i,this.far=r,this.focus=10,this.aspect=t,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.fov=e.fov,this.zoom=e.zoom,this.near=e.near,this.far=e.far,this.focus=e.focus,this.aspect=e.aspect,this.view=e.view===null?null:Object.assign({},e.view),this.filmGauge=e.filmGauge,this.filmOffset=e.filmOffset,this}setFocalLength(e){const t=.5*this.getFilmHeight()/e;this.fov=Nc*2*Math.atan(t),this.updateProjectionMatrix()}getFocalLength(){const e=Math.tan(Ic*.5*this.fov);return .5*this.getFilmHeight()/e}getEffectiveFOV(){return Nc*2*Math.atan(Math.tan(Ic*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(e,t,i){$i.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),t.set($i.x,$i.y).multiplyScalar(-e/$i.z),$i.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),i.set($i.x,$i.y).multiplyScalar(-e/$i.z)}getViewSize(e,t){return this.getViewBounds(e,hh,ph),t.subVectors(ph,hh)}setViewOffset(e,t,i,r,s,a){this.aspect=e/t,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=i,this.view.offsetY=r,this.view.width=s,this.view.height=a,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){const e=this.near;let t=e*Math.tan(Ic*.5*this.fov)/this.zoom,i=2*t,r=this.aspect*i,s=-.5*r;const a=this.view;if(this.view!==null&&this.view.enabled){const l=a.fullWidth,c=a.fullHeight;s+=a.offsetX*r/l,t-=a.offsetY*i/c,r*=a.width/l,i*=a.height/c}const o=this.filmOffset;o!==0&&(s+=e*o/this.getFilmWidth()),this.projectionMatrix.makePerspective(s,s+r,t,t-i,e,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){const t=super.toJSON(e);return t.object.fov=this.fov,t.object.zoom=this.zoom,t.object.near=this.near,t.object.far=this.far,t.object.focus=this.focus,t.object.aspect=this.aspect,this.view!==null&&(t.object.view=Object.assign({},this.view)),t.object.filmGauge=this.filmGauge,t.object.filmOffset=this.filmOffset,t}}class W_ extends dh{constructor(e=-1,t=1,i=1,r=-1,s=.1,a=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=e,this.right=t,this.top=i,this.bottom=r,this.near=s,this.far=a,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.left=e.left,this.right=e.right,this.top=e.top,this.bottom=e.bottom,this.near=e.near,this.far=e.far,this.zoom=e.zoom,this.view=e.view===null?null:Object.assign({},e.view),this}setViewOffset(e,t,i,r,s,a){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=i,this.view.offsetY=r,this.view.width=s,this.view.height=a,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){const e=(this.right-this.left)/(2*this.zoom),t=(this.top-this.bottom)/(2*this.zoom),i=(this.right+this.left)/2,r=(this.top+this.bottom)/2;let s=i-e,a=i+e,o=r+t,l=r-t;if(this.view!==null&&this.view.enabled){const c=(this.right-this.left)/this.view.fullWidth/this.zoom,f=(this.top-this.bottom)/this.view.fullHeight/this.zoom;s+=c*this.view.offsetX,a=s+c*this.view.width,o-=f*this.view.offsetY,l=o-f*this.view.height}this.projectionMatrix.makeOrthographic(s,a,o,l,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){const t=super.toJSON(e);return t.object.zoom=this.zoom,t.object.left=this.left,t.object.right=this.right,t.object.top=this.top,t.object.bottom=this.bottom,t.object.near=this.near,t.object.far=this.far,this.view!==null&&(t.object.view=Object.assign({},this.view)),t}}const rs=-90,ss=1;class au extends ln{constructor(e,t,i){super(),this.type="CubeCamera",this.renderTarget=i,this.coordinateSystem=null,this.activeMipmapLevel=0;const r=new yn(rs,ss,e,t);r.layers=this.layers,this.add(r);const s=new yn(rs,ss,e,t);s.layers=this.layers,this.add(s);const a=new yn(rs,ss,e,t);a.layers=this.layers,this.add(a);const o=new yn(rs,ss,e,t);o.layers=this.layers,this.add(o);const l=new yn(rs,ss,e,t);l.layers=this.layers,this.add(l);const c=new yn(rs,ss,e,t);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){const e=this.coordinateSystem,t=this.children.concat(),[i,r,s,a,o,l]=t;for(const c of t)this.remove(c);if(e===Ln)i.up.set(0,1,0),i.lookAt(1,0,0),r.up.set(0,1,0),r.lookAt(-1,0,0),s.up.set(0,0,-1),s.lookAt(0,1,0),a.up.set(0,0,1),a.lookAt(0,-1,0),o.up.set(0,1,0),o.lookAt(0,0,1),l.up.set(0,1,0),l.lookAt(0,0,-1);else if(e===Va)i.up.set(0,-1,0),i.lookAt(-1,0,0),r.up.set(0,-1,0),r.lookAt(1,0,0),s.up.set(0,0,1),s.lookAt(0,1,0),a.up.set(0,0,-1),a.lookAt(0,-1,0),o.up.set(0,-1,0),o.lookAt(0,0,1),l.up.set(0,-1,0),l.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+e);for(const c of t)this.add(c),c.updateMatrixWorld()}update(e,t){this.parent===null&&this.updateMatrixWorld();const{renderTarget:i,activeMipmapLevel:r}=this;this.coordinateSystem!==e.coordinateSystem&&(this.coordinateSystem=e.coordinateSystem,this.updateCoordinateSystem());const[s,a,o,l,c,f]=this.children,d=e.getRenderTarget(),u=e.getActiveCubeFace(),h=e.getActiveMipmapLevel(),g=e.xr.enabled;e.xr.enabled=!1;const x=i.texture.mipmapsAutoUpdate;i.texture.mipmapsAutoUpdate=!1;let m=!1;e.isWebGLRenderer===!0?m=e.state.buffers.depth.getReversed():m=e.reversedDepthBuffer,e.setRenderTarget(i,0,r),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,s),e.setRenderTarget(i,1,r),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,a),e.setRenderTarget(i,2,r),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,o),e.setRenderTarget(i,3,r),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,l),e.setRenderTarget(i,4,r),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,c),i.texture.mipmapsAutoUpdate=x,e.setRenderTarget(i,5,r),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,f),e.setRenderTarget(d,u,h),e.xr.enabled=g,i.texture.needsPMREMUpdate=!0}}class $_ extends yn{constructor(e=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=e,this.perCameraFrustumCulled=!1}}const mh=new N,Mo=new N,as=new N,os=new N,ou=new N,X_=new N,q_=new N;class bi{constructor(e=new N,t=new N){this.start=e,this.end=t}set(e,t){return this.start.copy(e),this.end.copy(t),this}copy(e){return this.start.copy(e.start),this.end.copy(e.end),this}getCenter(e){return e.addVectors(this.start,this.end).multiplyScalar(.5)}delta(e){return e.subVectors(this.end,this.start)}distanceSq(){return this.start.distanceToSquared(this.end)}distance(){return this.start.distanceTo(this.end)}at(e,t){return this.delta(t).multiplyScalar(e).add(this.start)}closestPointToPointParameter(e,t){mh.subVectors(e,this.start),Mo.subVectors(this.end,this.start);const i=Mo.dot(Mo);if(i===0)return 0;let s=Mo.dot(mh)/i;return t&&(s=Oe(s,0,1)),s}closestPointToPoint(e,t,i){const r=this.closestPointToPointParameter(e,t);return this.delta(i).multiplyScalar(r).add(this.start)}distanceSqToLine3(e,t=X_,i=q_){const r=10000000000000001e-32;let s,a;const o=this.start,l=e.start,c=this.end,f=e.end;as.subVectors(c,o),os.subVectors(f,l),ou.subVectors(o,l);const d=as.dot(as),u=os.dot(os),h=os.dot(ou);if(d<=r&&u<=r)return t.copy(o),i.copy(l),t.distanceToSquared(i);if(d<=r)s=0,a=h/u,a=Oe(a,0,1);else{const g=as.dot(ou);if(u<=r)a=0,s=Oe(-g/d,0,1);else{const x=as.dot(os),m=d*u-x*x;m!==0?s=Oe((x*h-g*u)/m,0,1):s=0,a=(x*s+h)/u,a<0?(a=0,s=Oe(-g/d,0,1)):a>1&&(a=1,s=Oe((x-g)/d,0,1))}}return t.copy(o).addScaledVector(as,s),i.copy(l).addScaledVector(os,a),t.distanceToSquared(i)}applyMatrix4(e){return this.start.applyMatrix4(e),this.end.applyMatrix4(e),this}equals(e){return e.start.equals(this.start)&&e.end.equals(this.end)}clone(){return new this.constructor().copy(this)}}function gh(n,e,t,i){const r=Y_(i);switch(t){case wd:return n*e;case Ad:return n*e/r.components*r.byteLength;case Ql:return n*e/r.components*r.byteLength;case hr:return n*e*2/r.components*r.byteLength;case jl:return n*e*2/r.components*r.byteLength;case Td:return n*e*3/r.components*r.byteLength;case $n:return n*e*4/r.components*r.byteLength;case ec:return n*e*4/r.components*r.byteLength;case Ua:case Fa:return Math.floor((n+3)/4)*Math.floor((e+3)/4)*8;case Oa:case Ba:return Math.floor((n+3)/4)*Math.floor((e+3)/4)*16;case nc:case rc:return Math.max(n,16)*Math.max(e,8)/4;case tc:case ic:return Math.max(n,8)*Math.max(e,8)/2;case sc:case ac:case lc:case cc:return Math.floor((n+3)/4)*Math.floor((e+3)/4)*8;case oc:case ka:case uc:return Math.floor((n+3)/4)*Math.floor((e+3)/4)*16;case fc:return Math.floor((n+3)/4)*Math.floor((e+3)/4)*16;case dc:return Math.floor((n+4)/5)*Math.floor((e+3)/4)*16;case hc:return Math.floor((n+4)/5)*Math.floor((e+4)/5)*16;case pc:return Math.floor((n+5)/6)*Math.floor((e+4)/5)*16;case mc:return Math.floor((n+5)/6)*Math.floor((e+5)/6)*16;case gc:return Math.floor((n+7)/8)*Math.floor((e+4)/5)*16;case _c:return Math.floor((n+7)/8)*Math.floor((e+5)/6)*16;case vc:return Math.floor((n+7)/8)*Math.floor((e+7)/8)*16;case xc:return Math.floor((n+9)/10)*Math.floor((e+4)/5)*16;case Sc:return Math.floor((n+9)/10)*Math.floor((e+5)/6)*16;case Mc:return Math.floor((n+9)/10)*Math.floor((e+7)/8)*16;case yc:return Math.floor((n+9)/10)*Math.floor((e+9)/10)*16;case bc:return Math.floor((n+11)/12)*Math.floor((e+9)/10)*16;case Ec:return Math.floor((n+11)/12)*Math.floor((e+11)/12)*16;case wc:case Tc:case Ac:return Math.ceil(n/4)*Math.ceil(e/4)*16;case Rc:case Cc:return Math.ceil(n/4)*Math.ceil(e/4)*8;case za:case Pc:return Math.ceil(n/4)*Math.ceil(e/4)*16}throw new Error(`Unable to determine texture byte length for ${t} format.`)}function Y_(n){switch(n){case xn:case Md:return{byteLength:1,components:1};case Gs:case yd:case Wn:return{byteLength:2,components:1};case Zl:case Jl:return{byteLength:2,components:4};case Gn:case Kl:case Vn:return{byteLength:4,components:1};case bd:case Ed:return{byteLength:4,components:3}}throw new Error(`THREE.TextureUtils: Unknown texture type ${n}.`)}typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:Os}})),typeof window<"u"&&(window.__THREE__?Le("WARNING: Multiple instances of Three.js being imported."):window.__THREE__=Os);function _h(){let n=null,e=!1,t=null,i=null;function r(s,a){i=n.requestAnimationFrame(r),t(s,a)}return{start:function(){e!==!0&&t!==null&&n!==null&&(i=n.requestAnimationFrame(r),e=!0)},stop:function(){n!==null&&n.cancelAnimationFrame(i),e=!1},setAnimationLoop:function(s){t=s},setContext:function(s){n=s}}}function K_(n){const e=new WeakMap;function t(o,l){const c=o.array,f=o.usage,d=c.byteLength,u=n.createBuffer();n.bindBuffer(l,u),n.bufferData(l,c,f),o.onUploadCallback();let h;if(c instanceof Float32Array)h=n.FLOAT;else if(typeof Float16Array<"u"&&c instanceof Float16Array)h=n.HALF_FLOAT;else if(c instanceof Uint16Array)o.isFloat16BufferAttribute?h=n.HALF_FLOAT:h=n.UNSIGNED_SHORT;else if(c instanceof Int16Array)h=n.SHORT;else if(c instanceof Uint32Array)h=n.UNSIGNED_INT;else if(c instanceof Int32Array)h=n.INT;else if(c instanceof Int8Array)h=n.BYTE;else if(c instanceof Uint8Array)h=n.UNSIGNED_BYTE;else if(c instanceof Uint8ClampedArray)h=n.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+c);return{buffer:u,type:h,bytesPerElement:c.BYTES_PER_ELEMENT,version:o.version,size:d}}function i(o,l,c){const f=l.array,d=l.updateRanges;if(n.bindBuffer(c,o),d.length===0)n.bufferSubData(c,0,f);else{d.sort((h,g)=>h.start-g.start);let u=0;for(let h=1;h<d.length;h++){const g=d[u],x=d[h];x.start<=g.start+g.count+1?g.count=Math.max(g.count,x.start+x.count-g.start):(++u,d[u]=x)}d.length=u+1;for(let h=0,g=d.length;h<g;h++){const x=d[h];n.bufferSubData(c,x.start*f.BYTES_PER_ELEMENT,f,x.start,x.count)}l.clearUpdateRanges()}l.onUploadCallback()}function r(o){return o.isInterleavedBufferAttribute&&(o=o.data),e.get(o)}function s(o){o.isInterleavedBufferAttribute&&(o=o.data);const l=e.get(o);l&&(n.deleteBuffer(l.buffer),e.delete(o))}function a(o,l){if(o.isInterleavedBufferAttribute&&(o=o.data),o.isGLBufferAttribute){const f=e.get(o);(!f||f.version<o.version)&&e.set(o,{buffer:o.buffer,type:o.type,bytesPerElement:o.elementSize,version:o.version});return}const c=e.get(o);if(c===void 0)e.set(o,t(o,l));else if(c.version<o.version){if(c.size!==o.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");i(c.buffer,o,l),c.version=o.version}}return{get:r,remove:s,update:a}}var Z_=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,J_=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,Q_=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,j_=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,e0=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,t0=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,n0=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,i0=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,r0=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,s0=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,a0=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,o0=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,l0=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,c0=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,u0=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,f0=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,d0=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,h0=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,p0=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,m0=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,g0=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,_0=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,v0=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,x0=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,S0=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,M0=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,y0=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,b0=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,E0=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,w0="gl_FragColor = linearToOutputTexel( gl_FragColor );",T0=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,A0=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,R0=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,C0=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,P0=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,L0=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,D0=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,I0=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,N0=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,U0=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,F0=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,O0=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,B0=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,k0=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,z0=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,H0=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,G0=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,V0=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,W0=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,$0=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,X0=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,q0=`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,Y0=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,K0=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,Z0=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,J0=`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,Q0=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,j0=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,ev=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,tv=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,nv=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,iv=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,rv=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,sv=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,av=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,ov=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,lv=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,cv=`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,uv=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,fv=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,dv=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,hv=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,pv=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,mv=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,gv=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,_v=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,vv=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,xv=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,Sv=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,Mv=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,yv=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,bv=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,Ev=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,wv=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,Tv=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,Av=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,Rv=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,Cv=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,Pv=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,Lv=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,Dv=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,Iv=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,Nv=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,Uv=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,Fv=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,Ov=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,Bv=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,kv=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,zv=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,Hv=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,Gv=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,Vv=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,Wv=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,$v=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,Xv=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,qv=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,Yv=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`;const ze={alphahash_fragment:Z_,alphahash_pars_fragment:J_,alphamap_fragment:Q_,alphamap_pars_fragment:j_,alphatest_fragment:e0,alphatest_pars_fragment:t0,aomap_fragment:n0,aomap_pars_fragment:i0,batching_pars_vertex:r0,batching_vertex:s0,begin_vertex:a0,beginnormal_vertex:o0,bsdfs:l0,iridescence_fragment:c0,bumpmap_pars_fragment:u0,clipping_planes_fragment:f0,clipping_planes_pars_fragment:d0,clipping_planes_pars_vertex:h0,clipping_planes_vertex:p0,color_fragment:m0,color_pars_fragment:g0,color_pars_vertex:_0,color_vertex:v0,common:x0,defaultnormal_vertex:S0,displacementmap_pars_vertex:M0,displacementmap_vertex:y0,emissivemap_fragment:b0,emissivemap_pars_fragment:E0,colorspace_fragment:w0,colorspace_pars_fragment:T0,envmap_fragment:A0,envmap_common_pars_fragment:R0,envmap_pars_fragment:C0,envmap_pars_vertex:P0,envmap_physical_pars_fragment:H0,envmap_vertex:L0,fog_vertex:D0,fog_pars_vertex:I0,fog_fragment:N0,fog_pars_fragment:U0,gradientmap_pars_fragment:F0,lightmap_pars_fragment:O0,lights_lambert_fragment:B0,lights_lambert_pars_fragment:k0,lights_pars_begin:z0,lights_toon_fragment:G0,lights_toon_pars_fragment:V0,lights_phong_fragment:W0,lights_phong_pars_fragment:$0,lights_physical_fragment:X0,lights_physical_pars_fragment:q0,lights_fragment_begin:Y0,lights_fragment_maps:K0,lights_fragment_end:Z0,lightprobes_pars_fragment:J0,logdepthbuf_fragment:Q0,logdepthbuf_pars_fragment:j0,logdepthbuf_pars_vertex:ev,logdepthbuf_vertex:tv,map_fragment:nv,map_pars_fragment:iv,map_particle_fragment:rv,map_particle_pars_fragment:sv,metalnessmap_fragment:av,metalnessmap_pars_fragment:ov,morphinstance_vertex:lv,morphcolor_vertex:cv,morphnormal_vertex:uv,morphtarget_pars_vertex:fv,morphtarget_vertex:dv,normal_fragment_begin:hv,normal_fragment_maps:pv,normal_pars_fragment:mv,normal_pars_vertex:gv,normal_vertex:_v,normalmap_pars_fragment:vv,clearcoat_normal_fragment_begin:xv,clearcoat_normal_fragment_maps:Sv,clearcoat_pars_fragment:Mv,iridescence_pars_fragment:yv,opaque_fragment:bv,packing:Ev,premultiplied_alpha_fragment:wv,project_vertex:Tv,dithering_fragment:Av,dithering_pars_fragment:Rv,roughnessmap_fragment:Cv,roughnessmap_pars_fragment:Pv,shadowmap_pars_fragment:Lv,shadowmap_pars_vertex:Dv,shadowmap_vertex:Iv,shadowmask_pars_fragment:Nv,skinbase_vertex:Uv,skinning_pars_vertex:Fv,skinning_vertex:Ov,skinnormal_vertex:Bv,specularmap_fragment:kv,specularmap_pars_fragment:zv,tonemapping_fragment:Hv,tonemapping_pars_fragment:Gv,transmission_fragment:Vv,transmission_pars_fragment:Wv,uv_pars_fragment:$v,uv_pars_vertex:Xv,uv_vertex:qv,worldpos_vertex:Yv,background_vert:`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,background_frag:`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,backgroundCube_vert:`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,backgroundCube_frag:`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,cube_vert:`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,cube_frag:`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,depth_vert:`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,depth_frag:`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,distance_vert:`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,distance_frag:`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,equirect_vert:`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,equirect_frag:`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,linedashed_vert:`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,linedashed_frag:`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,meshbasic_vert:`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,meshbasic_frag:`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshlambert_vert:`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,meshlambert_frag:`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshmatcap_vert:`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,meshmatcap_frag:`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshnormal_vert:`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,meshnormal_frag:`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,meshphong_vert:`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,meshphong_frag:`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshphysical_vert:`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,meshphysical_frag:`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshtoon_vert:`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,meshtoon_frag:`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,points_vert:`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,points_frag:`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,shadow_vert:`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,shadow_frag:`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,sprite_vert:`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,sprite_frag:`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`},me={common:{diffuse:{value:new Je(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new Fe},alphaMap:{value:null},alphaMapTransform:{value:new Fe},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new Fe}},envmap:{envMap:{value:null},envMapRotation:{value:new Fe},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new Fe}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new Fe}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new Fe},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new Fe},normalScale:{value:new We(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new Fe},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new Fe}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new Fe}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new Fe}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new Je(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new Je(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new Fe},alphaTest:{value:0},uvTransform:{value:new Fe}},sprite:{diffuse:{value:new Je(16777215)},opacity:{value:1},center:{value:new We(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new Fe},alphaMap:{value:null},alphaMapTransform:{value:new Fe},alphaTest:{value:0}}},Kn={basic:{uniforms:rn([me.common,me.specularmap,me.envmap,me.aomap,me.lightmap,me.fog]),vertexShader:ze.meshbasic_vert,fragmentShader:ze.meshbasic_frag},lambert:{uniforms:rn([me.common,me.specularmap,me.envmap,me.aomap,me.lightmap,me.emissivemap,me.bumpmap,me.normalmap,me.displacementmap,me.fog,me.lights,{emissive:{value:new Je(0)},envMapIntensity:{value:1}}]),vertexShader:ze.meshlambert_vert,fragmentShader:ze.meshlambert_frag},phong:{uniforms:rn([me.common,me.specularmap,me.envmap,me.aomap,me.lightmap,me.emissivemap,me.bumpmap,me.normalmap,me.displacementmap,me.fog,me.lights,{emissive:{value:new Je(0)},specular:{value:new Je(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:ze.meshphong_vert,fragmentShader:ze.meshphong_frag},standard:{uniforms:rn([me.common,me.envmap,me.aomap,me.lightmap,me.emissivemap,me.bumpmap,me.normalmap,me.displacementmap,me.roughnessmap,me.metalnessmap,me.fog,me.lights,{emissive:{value:new Je(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:ze.meshphysical_vert,fragmentShader:ze.meshphysical_frag},toon:{uniforms:rn([me.common,me.aomap,me.lightmap,me.emissivemap,me.bumpmap,me.normalmap,me.displacementmap,me.gradientmap,me.fog,me.lights,{emissive:{value:new Je(0)}}]),vertexShader:ze.meshtoon_vert,fragmentShader:ze.meshtoon_frag},matcap:{uniforms:rn([me.common,me.bumpmap,me.normalmap,me.displacementmap,me.fog,{matcap:{value:null}}]),vertexShader:ze.meshmatcap_vert,fragmentShader:ze.meshmatcap_frag},points:{uniforms:rn([me.points,me.fog]),vertexShader:ze.points_vert,fragmentShader:ze.points_frag},dashed:{uniforms:rn([me.common,me.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:ze.linedashed_vert,fragmentShader:ze.linedashed_frag},depth:{uniforms:rn([me.common,me.displacementmap]),vertexShader:ze.depth_vert,fragmentShader:ze.depth_frag},normal:{uniforms:rn([me.common,me.bumpmap,me.normalmap,me.displacementmap,{opacity:{value:1}}]),vertexShader:ze.meshnormal_vert,fragmentShader:ze.meshnormal_frag},sprite:{uniforms:rn([me.sprite,me.fog]),vertexShader:ze.sprite_vert,fragmentShader:ze.sprite_frag},background:{uniforms:{uvTransform:{value:new Fe},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:ze.background_vert,fragmentShader:ze.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new Fe}},vertexShader:ze.backgroundCube_vert,fragmentShader:ze.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:ze.cube_vert,fragmentShader:ze.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:ze.equirect_vert,fragmentShader:ze.equirect_frag},distance:{uniforms:rn([me.common,me.displacementmap,{referencePosition:{value:new N},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:ze.distance_vert,fragmentShader:ze.distance_frag},shadow:{uniforms:rn([me.lights,me.fog,{color:{value:new Je(0)},opacity:{value:1}}]),vertexShader:ze.shadow_vert,fragmentShader:ze.shadow_frag}};Kn.physical={uniforms:rn([Kn.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new Fe},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new Fe},clearcoatNormalScale:{value:new We(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new Fe},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new Fe},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new Fe},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new Fe},sheen:{value:0},sheenColor:{value:new Je(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new Fe},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new Fe},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new Fe},transmissionSamplerSize:{value:new We},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new Fe},attenuationDistance:{value:0},attenuationColor:{value:new Je(0)},specularColor:{value:new Je(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new Fe},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new Fe},anisotropyVector:{value:new We},anisotropyMap:{value:null},anisotropyMapTransform:{value:new Fe}}]),vertexShader:ze.meshphysical_vert,fragmentShader:ze.meshphysical_frag};const yo={r:0,b:0,g:0},Kv=new tt,vh=new Fe;vh.set(-1,0,0,0,1,0,0,0,1);function Zv(n,e,t,i,r,s){const a=new Je(0);let o=r===!0?0:1,l,c,f=null,d=0,u=null;function h(v){let y=v.isScene===!0?v.background:null;if(y&&y.isTexture){const S=v.backgroundBlurriness>0;y=e.get(y,S)}return y}function g(v){let y=!1;const S=h(v);S===null?m(a,o):S&&S.isColor&&(m(S,1),y=!0);const E=n.xr.getEnvironmentBlendMode();E==="additive"?t.buffers.color.setClear(0,0,0,1,s):E==="alpha-blend"&&t.buffers.color.setClear(0,0,0,0,s),(n.autoClear||y)&&(t.buffers.depth.setTest(!0),t.buffers.depth.setMask(!0),t.buffers.color.setMask(!0),n.clear(n.autoClearColor,n.autoClearDepth,n.autoClearStencil))}function x(v,y){const S=h(y);S&&S.isCubeTexture?(c===void 0&&(c=new yi(new Zs(1,1,1),new Wi({name:"BackgroundCubeMaterial",uniforms:is(Kn.backgroundCube.uniforms),vertexShader:Kn.backgroundCube.vertexShader,fragmentShader:Kn.backgroundCube.fragmentShader,side:en,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute("normal"),c.geometry.deleteAttribute("uv"),c.onBeforeRender=function(E,A,_){this.matrixWorld.copyPosition(_.matrixWorld)},Object.defineProperty(c.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),i.update(c)),c.material.uniforms.envMap.value=S,c.material.uniforms.backgroundBlurriness.value=y.backgroundBlurriness,c.material.uniforms.backgroundIntensity.value=y.backgroundIntensity,c.material.uniforms.backgroundRotation.value.setFromMatrix4(Kv.makeRotationFromEuler(y.backgroundRotation)).transpose(),S.isRenderTargetTexture===!1&&c.material.uniforms.backgroundRotation.value.premultiply(vh),c.material.toneMapped=Ye.getTransfer(S.colorSpace)!==nt,(f!==S||d!==S.version||u!==n.toneMapping)&&(c.material.needsUpdate=!0,f=S,d=S.version,u=n.toneMapping),c.layers.enableAll(),v.unshift(c,c.geometry,c.material,0,0,null)):S&&S.isTexture&&(l===void 0&&(l=new yi(new vo(2,2),new Wi({name:"BackgroundMaterial",uniforms:is(Kn.background.uniforms),vertexShader:Kn.background.vertexShader,fragmentShader:Kn.background.fragmentShader,side:hi,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute("normal"),Object.defineProperty(l.material,"map",{get:function(){return this.uniforms.t2D.value}}),i.update(l)),l.material.uniforms.t2D.value=S,l.material.uniforms.backgroundIntensity.value=y.backgroundIntensity,l.material.toneMapped=Ye.getTransfer(S.colorSpace)!==nt,S.matrixAutoUpdate===!0&&S.updateMatrix(),l.material.uniforms.uvTransform.value.copy(S.matrix),(f!==S||d!==S.version||u!==n.toneMapping)&&(l.material.needsUpdate=!0,f=S,d=S.version,u=n.toneMapping),l.layers.enableAll(),v.unshift(l,l.geometry,l.material,0,0,null))}function m(v,y){v.getRGB(yo,fh(n)),t.buffers.color.setClear(yo.r,yo.g,yo.b,y,s)}function p(){c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0),l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0)}return{getClearColor:function(){return a},setClearColor:function(v,y=1){a.set(v),o=y,m(a,o)},getClearAlpha:function(){return o},setClearAlpha:function(v){o=v,m(a,o)},render:g,addToRenderList:x,dispose:p}}function Jv(n,e){const t=n.getParameter(n.MAX_VERTEX_ATTRIBS),i={},r=u(null);let s=r,a=!1;function o(P,D,O,L,k){let V=!1;const W=d(P,L,O,D);s!==W&&(s=W,c(s.object)),V=h(P,L,O,k),V&&g(P,L,O,k),k!==null&&e.update(k,n.ELEMENT_ARRAY_BUFFER),(V||a)&&(a=!1,S(P,D,O,L),k!==null&&n.bindBuffer(n.ELEMENT_ARRAY_BUFFER,e.get(k).buffer))}function l(){return n.createVertexArray()}function c(P){return n.bindVertexArray(P)}function f(P){return n.deleteVertexArray(P)}function d(P,D,O,L){const k=L.wireframe===!0;let V=i[D.id];V===void 0&&(V={},i[D.id]=V);const W=P.isInstancedMesh===!0?P.id:0;let te=V[W];te===void 0&&(te={},V[W]=te);let X=te[O.id];X===void 0&&(X={},te[O.id]=X);let j=X[k];return j===void 0&&(j=u(l()),X[k]=j),j}function u(P){const D=[],O=[],L=[];for(let k=0;k<t;k++)D[k]=0,O[k]=0,L[k]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:D,enabledAttributes:O,attributeDivisors:L,object:P,attributes:{},index:null}}function h(P,D,O,L){const k=s.attributes,V=D.attributes;let W=0;const te=O.getAttributes();for(const X in te)if(te[X].location>=0){const ee=k[X];let Se=V[X];if(Se===void 0&&(X==="instanceMatrix"&&P.instanceMatrix&&(Se=P.instanceMatrix),X==="instanceColor"&&P.instanceColor&&(Se=P.instanceColor)),ee===void 0||ee.attribute!==Se||Se&&ee.data!==Se.data)return!0;W++}return s.attributesNum!==W||s.index!==L}function g(P,D,O,L){const k={},V=D.attributes;let W=0;const te=O.getAttributes();for(const X in te)if(te[X].location>=0){let ee=V[X];ee===void 0&&(X==="instanceMatrix"&&P.instanceMatrix&&(ee=P.instanceMatrix),X==="instanceColor"&&P.instanceColor&&(ee=P.instanceColor));const Se={};Se.attribute=ee,ee&&ee.data&&(Se.data=ee.data),k[X]=Se,W++}s.attributes=k,s.attributesNum=W,s.index=L}function x(){const P=s.newAttributes;for(let D=0,O=P.length;D<O;D++)P[D]=0}function m(P){p(P,0)}function p(P,D){const O=s.newAttributes,L=s.enabledAttributes,k=s.attributeDivisors;O[P]=1,L[P]===0&&(n.enableVertexAttribArray(P),L[P]=1),k[P]!==D&&(n.vertexAttribDivisor(P,D),k[P]=D)}function v(){const P=s.newAttributes,D=s.enabledAttributes;for(let O=0,L=D.length;O<L;O++)D[O]!==P[O]&&(n.disableVertexAttribArray(O),D[O]=0)}function y(P,D,O,L,k,V,W){W===!0?n.vertexAttribIPointer(P,D,O,k,V):n.vertexAttribPointer(P,D,O,L,k,V)}function S(P,D,O,L){x();const k=L.attributes,V=O.getAttributes(),W=D.defaultAttributeValues;for(const te in V){const X=V[te];if(X.location>=0){let j=k[te];if(j===void 0&&(te==="instanceMatrix"&&P.instanceMatrix&&(j=P.instanceMatrix),te==="instanceColor"&&P.instanceColor&&(j=P.instanceColor)),j!==void 0){const ee=j.normalized,Se=j.itemSize,De=e.get(j);if(De===void 0)continue;const Z=De.buffer,fe=De.type,xe=De.bytesPerElement,Ae=fe===n.INT||fe===n.UNSIGNED_INT||j.gpuType===Kl;if(j.isInterleavedBufferAttribute){const ge=j.data,Ie=ge.isInterleavedBuffer===!0?ge.stride:ge.itemSize,_t=j.offset;if(ge.isInstancedInterleavedBuffer||ge.isInstancedBufferAttribute){for(let Re=0;Re<X.locationSize;Re++)p(X.location+Re,ge.meshPerAttribute);P.isInstancedMesh!==!0&&L._maxInstanceCount===void 0&&(L._maxInstanceCount=ge.meshPerAttribute*ge.count)}else for(let Re=0;Re<X.locationSize;Re++)m(X.location+Re);n.bindBuffer(n.ARRAY_BUFFER,Z);for(let Re=0;Re<X.locationSize;Re++)y(X.location+Re,Se/X.locationSize,fe,ee,Ie*xe,(_t+Se/X.locationSize*Re)*xe,Ae)}else{if(j.isInstancedBufferAttribute){for(let ge=0;ge<X.locationSize;ge++)p(X.location+ge,j.meshPerAttribute);P.isInstancedMesh!==!0&&L._maxInstanceCount===void 0&&(L._maxInstanceCount=j.meshPerAttribute*j.count)}else for(let ge=0;ge<X.locationSize;ge++)m(X.location+ge);n.bindBuffer(n.ARRAY_BUFFER,Z);for(let ge=0;ge<X.locationSize;ge++)y(X.location+ge,Se/X.locationSize,fe,ee,Se*xe,Se/X.locationSize*ge*xe,Ae)}}else if(W!==void 0){const ee=W[te];if(ee!==void 0)switch(ee.length){case 2:n.vertexAttrib2fv(X.location,ee);break;case 3:n.vertexAttrib3fv(X.location,ee);break;case 4:n.vertexAttrib4fv(X.location,ee);break;default:n.vertexAttrib1fv(X.location,ee)}}}}v()}function E(){I();for(const P in i){const D=i[P];for(const O in D){const L=D[O];for(const k in L){const V=L[k];for(const W in V)f(V[W].object),delete V[W];delete L[k]}}delete i[P]}}function A(P){if(i[P.id]===void 0)return;const D=i[P.id];for(const O in D){const L=D[O];for(const k in L){const V=L[k];for(const W in V)f(V[W].object),delete V[W];delete L[k]}}delete i[P.id]}function _(P){for(const D in i){const O=i[D];for(const L in O){const k=O[L];if(k[P.id]===void 0)continue;const V=k[P.id];for(const W in V)f(V[W].object),delete V[W];delete k[P.id]}}}function b(P){for(const D in i){const O=i[D],L=P.isInstancedMesh===!0?P.id:0,k=O[L];if(k!==void 0){for(const V in k){const W=k[V];for(const te in W)f(W[te].object),delete W[te];delete k[V]}delete O[L],Object.keys(O).length===0&&delete i[D]}}}function I(){R(),a=!0,s!==r&&(s=r,c(s.object))}function R(){r.geometry=null,r.program=null,r.wireframe=!1}return{setup:o,reset:I,resetDefaultState:R,dispose:E,releaseStatesOfGeometry:A,releaseStatesOfObject:b,releaseStatesOfProgram:_,initAttributes:x,enableAttribute:m,disableUnusedAttributes:v}}function Qv(n,e,t){let i;function r(l){i=l}function s(l,c){n.drawArrays(i,l,c),t.update(c,i,1)}function a(l,c,f){f!==0&&(n.drawArraysInstanced(i,l,c,f),t.update(c,i,f))}function o(l,c,f){if(f===0)return;e.get("WEBGL_multi_draw").multiDrawArraysWEBGL(i,l,0,c,0,f);let u=0;for(let h=0;h<f;h++)u+=c[h];t.update(u,i,1)}this.setMode=r,this.render=s,this.renderInstances=a,this.renderMultiDraw=o}function jv(n,e,t,i){let r;function s(){if(r!==void 0)return r;if(e.has("EXT_texture_filter_anisotropic")===!0){const _=e.get("EXT_texture_filter_anisotropic");r=n.getParameter(_.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else r=0;return r}function a(_){return!(_!==$n&&i.convert(_)!==n.getParameter(n.IMPLEMENTATION_COLOR_READ_FORMAT))}function o(_){const b=_===Wn&&(e.has("EXT_color_buffer_half_float")||e.has("EXT_color_buffer_float"));return!(_!==xn&&_!==Vn&&!b&&i.convert(_)!==n.getParameter(n.IMPLEMENTATION_COLOR_READ_TYPE))}function l(_){if(_==="highp"){if(n.getShaderPrecisionFormat(n.VERTEX_SHADER,n.HIGH_FLOAT).precision>0&&n.getShaderPrecisionFormat(n.FRAGMENT_SHADER,n.HIGH_FLOAT).precision>0)return"highp";_="mediump"}return _==="mediump"&&n.getShaderPrecisionFormat(n.VERTEX_SHADER,n.MEDIUM_FLOAT).precision>0&&n.getShaderPrecisionFormat(n.FRAGMENT_SHADER,n.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let c=t.precision!==void 0?t.precision:"highp";const f=l(c);f!==c&&(Le("WebGLRenderer:",c,"not supported, using",f,"instead."),c=f);const d=t.reversedDepthBuffer===!0&&e.has("EXT_clip_control"),u=t.logarithmicDepthBuffer===!0&&d===!1;t.reversedDepthBuffer===!0&&d===!1&&Le("WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer."),t.logarithmicDepthBuffer===!0&&d===!0&&Le("WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.");const h=n.getParameter(n.MAX_TEXTURE_IMAGE_UNITS),g=n.getParameter(n.MAX_VERTEX_TEXTURE_IMAGE_UNITS),x=n.getParameter(n.MAX_TEXTURE_SIZE),m=n.getParameter(n.MAX_CUBE_MAP_TEXTURE_SIZE),p=n.getParameter(n.MAX_VERTEX_ATTRIBS),v=n.getParameter(n.MAX_VERTEX_UNIFORM_VECTORS),y=n.getParameter(n.MAX_VARYING_VECTORS),S=n.getParameter(n.MAX_FRAGMENT_UNIFORM_VECTORS),E=n.getParameter(n.MAX_SAMPLES),A=n.getParameter(n.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:s,getMaxPrecision:l,textureFormatReadable:a,textureTypeReadable:o,precision:c,logarithmicDepthBuffer:u,reversedDepthBuffer:d,maxTextures:h,maxVertexTextures:g,maxTextureSize:x,maxCubemapSize:m,maxAttributes:p,maxVertexUniforms:v,maxVaryings:y,maxFragmentUniforms:S,maxSamples:E,samples:A}}function ex(n){const e=this;let t=null,i=0,r=!1,s=!1;const a=new qn,o=new Fe,l={value:null,needsUpdate:!1};this.uniform=l,this.numPlanes=0,this.numIntersection=0,this.init=function(d,u){const h=d.length!==0||u||i!==0||r;return r=u,i=d.length,h},this.beginShadows=function(){s=!0,f(null)},this.endShadows=function(){s=!1},this.setGlobalState=function(d,u){t=f(d,u,0)},this.setState=function(d,u,h){const g=d.clippingPlanes,x=d.clipIntersection,m=d.clipShadows,p=n.get(d);if(!r||g===null||g.length===0||s&&!m)s?f(null):c();else{const v=s?0:i,y=v*4;let S=p.clippingState||null;l.value=S,S=f(g,u,y,h);for(let E=0;E!==y;++E)S[E]=t[E];p.clippingState=S,this.numIntersection=x?this.numPlanes:0,this.numPlanes+=v}};function c(){l.value!==t&&(l.value=t,l.needsUpdate=i>0),e.numPlanes=i,e.numIntersection=0}function f(d,u,h,g){const x=d!==null?d.length:0;let m=null;if(x!==0){if(m=l.value,g!==!0||m===null){const p=h+x*4,v=u.matrixWorldInverse;o.getNormalMatrix(v),(m===null||m.length<p)&&(m=new Float32Array(p));for(let y=0,S=h;y!==x;++y,S+=4)a.copy(d[y]).applyMatrix4(v,o),a.normal.toArray(m,S),m[S+3]=a.constant}l.value=m,l.needsUpdate=!0}return e.numPlanes=x,e.numIntersection=0,m}}class lu extends Dn{constructor(e=1,t={}){super(e,e,t),this.isWebGLCubeRenderTarget=!0;const i={width:e,height:e,depth:1},r=[i,i,i,i,i,i];this.texture=new oh(r),this._setTextureOptions(t),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(e,t){this.texture.type=t.type,this.texture.colorSpace=t.colorSpace,this.texture.generateMipmaps=t.generateMipmaps,this.texture.minFilter=t.minFilter,this.texture.magFilter=t.magFilter;const i={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},r=new Zs(5,5,5),s=new Wi({name:"CubemapFromEquirect",uniforms:is(i.uniforms),vertexShader:i.vertexShader,fragmentShader:i.fragmentShader,side:en,blending:Hr});s.uniforms.tEquirect.value=t;const a=new yi(r,s),o=t.minFilter;return t.minFilter===Ui&&(t.minFilter=on),new au(1,10,this).update(e,a),t.minFilter=o,a.geometry.dispose(),a.material.dispose(),this}clear(e,t=!0,i=!0,r=!0){const s=e.getRenderTarget();for(let a=0;a<6;a++)e.setRenderTarget(this,a),e.clear(t,i,r);e.setRenderTarget(s)}}const xh=256,tx=3,nx=20,Sh=256,Mh=16,ix=3,rx=new N,sx=new Je;class bo{constructor(e){this._renderer=e,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new au(1,10,null),this._boxMesh=new yi(new Zs(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(e,t=0,i=.1,r=100,s={}){const{size:a=256,position:o=rx}=s,l=this._renderer;this._setSize(a);const c=this._allocateTarget(),f=this._getSourceTarget(!0);t>0&&(f.texture.mipmapsAutoUpdate=!1);const d=l.autoClear,u=l.autoClearColor,h=l.autoClearDepth,g=l.autoClearStencil,x=e.background;l.autoClear=!0,l.autoClearColor=!0,l.autoClearDepth=!0,l.autoClearStencil=!0,x===null&&(e.background=l.getClearColor(sx));const m=new au(i,r,f);return m.position.copy(o),m.update(l,e),l.autoClear=d,l.autoClearColor=u,l.autoClearDepth=h,l.autoClearStencil=g,e.background=x,t>0&&(f.texture.mipmapsAutoUpdate=!0,this._blur(c,t)),this._applyPMREM(c),c}fromEquirectangular(e,t=null){return this._fromTexture(e,t)}fromCubemap(e,t=null){return this._fromTexture(e,t)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=Eh(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=bh(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(e,t){return t>0?1-Math.sqrt(1-e/t):0}_setSize(e){this._cubeSize=Math.max(xh,c_(e))}_fromTexture(e,t){e.mapping===Vr||e.mapping===Hs?this._setSize(e.image.length===0?xh:e.image[0].width||e.image[0].image.width):this._setSize(e.image.width/4);const i=t||this._allocateTarget();return this._textureToCubemap(e),this._applyPMREM(i),i}_allocateTarget(){const e=this._cubeSize,t=yh(e,!1,!1),i=Math.log2(e)-tx;for(let r=0;r<=i;r++)t.texture.mipmaps.push({width:e>>r,height:e>>r});return t.texture.name="PMREM",t.texture.isPMREMTexture=!0,t}_getSourceTarget(e=!1){const t=this._cubeSize,i=this._sourceTarget;return(i===null||i.width!==t||e&&i.depthBuffer===!1)&&(i!==null&&i.dispose(),this._sourceTarget=yh(t,!0,e)),this._sourceTarget}_compileMaterial(e){this._boxMesh.material=e,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(e,t,i){const r=this._boxMesh,s=this._cubeCamera;r.material=i,s.renderTarget=e,s.activeMipmapLevel=t;const a=e.width>>t;e.viewport.set(0,0,a,a),s.update(this._renderer,r),e.viewport.set(0,0,e.width,e.height)}_textureToCubemap(e){let t;e.mapping===Vr||e.mapping===Hs?(this._cubemapMaterial===null&&(this._cubemapMaterial=Eh()),t=this._cubemapMaterial,t.uniforms.flipEnvMap.value=e.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=bh()),t=this._equirectMaterial),t.uniforms.envMap.value=e,this._renderCube(this._getSourceTarget(),0,t)}_applyPMREM(e){this._ggxMaterial===null&&(this._ggxMaterial=ax(),this._integrationMaterial=ox());const t=this._cubeSize,i=e.texture.mipmaps.length-1,r=this._ggxMaterial.uniforms;r.envMap.value=this._sourceTarget.texture;const s=this._integrationMaterial.uniforms;s.envMap.value=this._sourceTarget.texture,s.sourceLod.value=Math.log2(t/Mh);for(let a=0;a<=i;a++){const o=bo.lodToRoughness(a,i);if(a>i-ix)s.roughness.value=o,this._renderCube(e,a,this._integrationMaterial);else{const l=o>0?Math.log2(t)+.5*Math.log2(6/(Sh*Math.pow(o,4)))+.5:0;r.roughness.value=o,r.lodBias.value=l,this._renderCube(e,a,this._ggxMaterial)}}}_blur(e,t){this._blurMaterial===null&&(this._blurMaterial=lx());const i=this._blurMaterial,r=i.uniforms,s=this._sourceTarget;r.sigma.value=Math.min(t,Math.PI)/Math.SQRT2,r.envMap.value=s.texture,this._renderCube(e,0,i),r.envMap.value=e.texture,this._renderCube(s,0,i)}}function yh(n,e,t){return new lu(n,{minFilter:Ui,generateMipmaps:e,type:Wn,colorSpace:Ha,depthBuffer:t})}function Js(n,e,t){return new Wi({name:n,uniforms:e,vertexShader:ze.cube_vert,fragmentShader:t,side:en,blending:Hr,depthTest:!1,depthWrite:!1})}function ax(){return Js("PMREMGGXConvolution",{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${Sh}u

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float lodBias;

		#include <common>

		// Van der Corput radical inverse
		float radicalInverse_VdC( uint bits ) {

			bits = ( bits << 16u ) | ( bits >> 16u );
			bits = ( ( bits & 0x55555555u ) << 1u ) | ( ( bits & 0xAAAAAAAAu ) >> 1u );
			bits = ( ( bits & 0x33333333u ) << 2u ) | ( ( bits & 0xCCCCCCCCu ) >> 2u );
			bits = ( ( bits & 0x0F0F0F0Fu ) << 4u ) | ( ( bits & 0xF0F0F0F0u ) >> 4u );
			bits = ( ( bits & 0x00FF00FFu ) << 8u ) | ( ( bits & 0xFF00FF00u ) >> 8u );
			return float( bits ) * 2.3283064365386963e-10; // / 0x100000000

		}

		// Hammersley sequence
		vec2 hammersley( uint i, uint N ) {

			return vec2( float( i ) / float( N ), radicalInverse_VdC( i ) );

		}

		void main() {

			vec3 N = normalize( vWorldDirection );

			// For very low roughness, just sample the environment directly
			if ( roughness < 0.001 ) {

				gl_FragColor = vec4( textureLod( envMap, N, 0.0 ).rgb, 1.0 );
				return;

			}

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			// Tangent space basis for VNDF sampling
			vec3 up = abs( N.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, N ) );
			vec3 bitangent = cross( N, tangent );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			for ( uint i = 0u; i < GGX_SAMPLES; i ++ ) {

				vec2 Xi = hammersley( i, GGX_SAMPLES );

				// With V = N, sample the reflected direction directly.
				float invQ = 1.0 / ( 1.0 - Xi.x + alpha2 * Xi.x );
				float NdotL = ( 1.0 - Xi.x - alpha2 * Xi.x ) * invQ;

				if ( NdotL > 0.0 ) {

					float phi = 2.0 * PI * Xi.y;
					float sinTheta = 2.0 * alpha * sqrt( Xi.x * ( 1.0 - Xi.x ) ) * invQ;
					vec3 L = N * NdotL + ( tangent * cos( phi ) + bitangent * sin( phi ) ) * sinTheta;

					// Match the source mip to the sample's solid angle. The terms
					// independent of the sample are precomputed in lodBias.
					float d = alpha2 * invQ;
					float lod = max( log2( d ) + lodBias, 0.0 );

					// Weight by NdotL for the split-sum approximation
					prefilteredColor += textureLod( envMap, L, lod ).rgb * NdotL;
					totalWeight += NdotL;

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function ox(){return Js("PMREMGGXIntegration",{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:Mh}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float sourceLod;
		uniform int sourceSize;

		void main() {

			vec3 N = normalize( vWorldDirection );

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			float texelSize = 2.0 / float( sourceSize );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			// Pair opposite texels: only the one in N's hemisphere contributes.
			for ( int face = 0; face < 3; face ++ ) {

				for ( int y = 0; y < sourceSize; y ++ ) {

					for ( int x = 0; x < sourceSize; x ++ ) {

						vec2 uv = ( vec2( x, y ) + 0.5 ) * texelSize - 1.0;
						vec3 texelDirection = face == 0 ? vec3( 1.0, uv ) : ( face == 1 ? vec3( uv.x, 1.0, uv.y ) : vec3( uv, 1.0 ) );

						float invDistance = inversesqrt( 1.0 + dot( uv, uv ) );
						float NdotL = dot( N, texelDirection );
						texelDirection *= NdotL < 0.0 ? - 1.0 : 1.0;
						NdotL = abs( NdotL ) * invDistance;

						// With V = N, NdotH squared is ( 1 + NdotL ) / 2. Common factors
						// in the GGX distribution and texel solid angle cancel when normalized.
						float d = 1.0 + alpha2 + ( alpha2 - 1.0 ) * NdotL;
						float weight = NdotL * invDistance * invDistance * invDistance / ( d * d );

						prefilteredColor += textureLod( envMap, texelDirection, sourceLod ).rgb * weight;
						totalWeight += weight;

					}

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function lx(){return Js("PMREMSphericalGaussianBlur",{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${nx}
		#define GOLDEN_ANGLE 2.39996322973

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float sigma;

		#include <common>

		void main() {

			vec3 outputDirection = normalize( vWorldDirection );

			vec3 up = abs( outputDirection.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, outputDirection ) );
			vec3 bitangent = cross( outputDirection, tangent );

			// Truncate the kernel at three standard deviations or at the antipode.
			float thetaMax = min( 3.0 * sigma, PI );
			float truncation = 1.0 - exp( - 0.5 * thetaMax * thetaMax / ( sigma * sigma ) );

			vec3 accumColor = vec3( 0.0 );
			float accumWeight = 0.0;

			for ( int i = 0; i < SAMPLES; i ++ ) {

				// Stratified inverse-CDF sampling of the Gaussian, placed on a golden-angle spiral.
				float stratum = ( float( i ) + 0.5 ) / float( SAMPLES );
				float theta = sigma * sqrt( - 2.0 * log( 1.0 - stratum * truncation ) );
				float phi = float( i ) * GOLDEN_ANGLE;

				vec3 offset = cos( phi ) * tangent + sin( phi ) * bitangent;
				vec3 sampleDirection = cos( theta ) * outputDirection + sin( theta ) * offset;

				// Correct the planar sample density to solid angle.
				float weight = sin( theta ) / theta;

				accumColor += weight * textureLod( envMap, sampleDirection, 0.0 ).rgb;
				accumWeight += weight;

			}

			gl_FragColor = vec4( accumColor / accumWeight, 1.0 );

		}
	`)}function bh(){return Js("PMREMEquirectangularToCubemap",{envMap:{value:null}},`

		varying vec3 vWorldDirection;

		uniform sampler2D envMap;

		#include <common>

		void main() {

			// Average four subpixel samples to preserve small, bright features.
			vec3 direction = normalize( vWorldDirection );
			vec3 dx = dFdx( direction ) * 0.25;
			vec3 dy = dFdy( direction ) * 0.25;

			vec3 color = textureLod( envMap, equirectUv( normalize( direction - dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction - dx + dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx + dy ) ), 0.0 ).rgb;
			gl_FragColor = vec4( color * 0.25, 1.0 );

		}
	`)}function Eh(){return Js("PMREMCubemapToCubemap",{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function cx(n){let e=new WeakMap,t=new WeakMap,i=null;function r(u,h=!1){return u==null?null:h?a(u):s(u)}function s(u){if(u&&u.isTexture){const h=u.mapping;if(h===Wl||h===$l)if(e.has(u)){const g=e.get(u).texture;return o(g,u.mapping)}else{const g=u.image;if(g&&g.height>0){const x=new lu(g.height);return x.fromEquirectangularTexture(n,u),e.set(u,x),u.addEventListener("dispose",c),o(x.texture,u.mapping)}else return null}}return u}function a(u){if(u&&u.isTexture&&u.isPMREMTexture!==!0){const h=u.mapping,g=h===Wl||h===$l,x=h===Vr||h===Hs;if(g||x){let m=t.get(u);const p=m!==void 0?m.texture.pmremVersion:0;if(u.isRenderTargetTexture&&u.pmremVersion!==p)return i===null&&(i=new bo(n)),m=g?i.fromEquirectangular(u,m):i.fromCubemap(u,m),m.texture.pmremVersion=u.pmremVersion,t.set(u,m),m.texture;if(m!==void 0)return m.texture;{const v=u.image;return g&&v&&v.height>0||x&&v&&l(v)?(i===null&&(i=new bo(n)),m=g?i.fromEquirectangular(u):i.fromCubemap(u),m.texture.pmremVersion=u.pmremVersion,t.set(u,m),u.addEventListener("dispose",f),m.texture):null}}}return u}function o(u,h){return h===Wl?u.mapping=Vr:h===$l&&(u.mapping=Hs),u}function l(u){let h=0;const g=6;for(let x=0;x<g;x++)u[x]!==void 0&&h++;return h===g}function c(u){const h=u.target;h.removeEventListener("dispose",c);const g=e.get(h);g!==void 0&&(e.delete(h),g.dispose())}function f(u){const h=u.target;h.removeEventListener("dispose",f);const g=t.get(h);g!==void 0&&(t.delete(h),g.dispose())}function d(){e=new WeakMap,t=new WeakMap,i!==null&&(i.dispose(),i=null)}return{get:r,dispose:d}}function ux(n){const e={};function t(i){if(e[i]!==void 0)return e[i];const r=n.getExtension(i);return e[i]=r,r}return{has:function(i){return t(i)!==null},init:function(){t("EXT_color_buffer_float"),t("WEBGL_clip_cull_distance"),t("OES_texture_float_linear"),t("EXT_color_buffer_half_float"),t("WEBGL_multisampled_render_to_texture"),t("WEBGL_render_shared_exponent")},get:function(i){const r=t(i);return r===null&&$a("WebGLRenderer: "+i+" extension not supported."),r}}}function fx(n,e,t,i){const r={},s=new WeakMap,a=new FinalizationRegistry(g=>delete r[g]);function o(g){l(g.target)}function l(g){g.index!==null&&e.remove(g.index);for(const m in g.attributes)e.remove(g.attributes[m]);g.removeEventListener("dispose",o),delete r[g.id],a.unregister(g);const x=s.get(g);x&&(e.remove(x),s.delete(g)),i.releaseStatesOfGeometry(g),g.isInstancedBufferGeometry===!0&&delete g._maxInstanceCount,t.memory.geometries--}function c(g,x){return r[x.id]!==void 0||(x.addEventListener("dispose",o),r[x.id]=new WeakRef(x),a.register(x,x.id,x),t.memory.geometries++),x}function f(g){const x=g.attributes;for(const m in x)e.update(x[m],n.ARRAY_BUFFER)}function d(g){const x=g.index,m=g.attributes.position;let p=0;if(m===void 0)return;const v=x!==null?x.array.length:m.array.length/3-1,y=m.count>=65535?Jd:Zd,S=new y(Math.ceil(v/3)*6,1),E=S.array;if(x!==null){const _=x.array;p=x.version;for(let b=0,I=0;b<v;b+=3){const R=_[b+0],P=_[b+1],D=_[b+2];E[I++]=R,E[I++]=P,E[I++]=P,E[I++]=D,E[I++]=D,E[I++]=R}}else{p=m.version;for(let _=0,b=0;_<v;_+=3){const I=_+0,R=_+1,P=_+2;E[b++]=I,E[b++]=R,E[b++]=R,E[b++]=P,E[b++]=P,E[b++]=I}}S.version=p;const A=s.get(g);A&&e.remove(A),s.set(g,S)}function u(g){const x=s.get(g);if(x){const m=g.index;m!==null&&x.version<m.version&&d(g)}else d(g);return s.get(g)}function h(){for(const g in r){const x=r[g].deref();x!==void 0&&l(x)}}return{get:c,update:f,getWireframeAttribute:u,dispose:h}}function dx(n,e,t){let i;function r(d){i=d}let s,a;function o(d){s=d.type,a=d.bytesPerElement}function l(d,u){n.drawElements(i,u,s,d*a),t.update(u,i,1)}function c(d,u,h){h!==0&&(n.drawElementsInstanced(i,u,s,d*a,h),t.update(u,i,h))}function f(d,u,h){if(h===0)return;e.get("WEBGL_multi_draw").multiDrawElementsWEBGL(i,u,0,s,d,0,h);let x=0;for(let m=0;m<h;m++)x+=u[m];t.update(x,i,1)}this.setMode=r,this.setIndex=o,this.render=l,this.renderInstances=c,this.renderMultiDraw=f}function hx(n){const e={geometries:0,textures:0},t={frame:0,calls:0,triangles:0,points:0,lines:0};function i(s,a,o){switch(t.calls++,a){case n.TRIANGLES:t.triangles+=o*(s/3);break;case n.LINES:t.lines+=o*(s/2);break;case n.LINE_STRIP:t.lines+=o*(s-1);break;case n.LINE_LOOP:t.lines+=o*s;break;case n.POINTS:t.points+=o*s;break;default:Qe("WebGLInfo: Unknown draw mode:",a);break}}function r(){t.calls=0,t.triangles=0,t.points=0,t.lines=0}return{memory:e,render:t,programs:null,autoReset:!0,reset:r,update:i}}function px(n,e,t){const i=new WeakMap,r=new ot;function s(a,o,l){const c=a.morphTargetInfluences,f=o.morphAttributes.position||o.morphAttributes.normal||o.morphAttributes.color,d=f!==void 0?f.length:0;let u=i.get(o);if(u===void 0||u.count!==d){let I=function(){_.dispose(),i.delete(o),o.removeEventListener("dispose",I)};u!==void 0&&u.texture.dispose();const h=o.morphAttributes.position!==void 0,g=o.morphAttributes.normal!==void 0,x=o.morphAttributes.color!==void 0,m=o.morphAttributes.position||[],p=o.morphAttributes.normal||[],v=o.morphAttributes.color||[];let y=0;h===!0&&(y=1),g===!0&&(y=2),x===!0&&(y=3);let S=o.attributes.position.count*y,E=1;S>e.maxTextureSize&&(E=Math.ceil(S/e.maxTextureSize),S=e.maxTextureSize);const A=new Float32Array(S*E*4*d),_=new Bd(A,S,E,d);_.type=Vn,_.needsUpdate=!0;const b=y*4;for(let R=0;R<d;R++){const P=m[R],D=p[R],O=v[R],L=S*E*4*R;for(let k=0;k<P.count;k++){const V=k*b;h===!0&&(r.fromBufferAttribute(P,k),A[L+V+0]=r.x,A[L+V+1]=r.y,A[L+V+2]=r.z,A[L+V+3]=0),g===!0&&(r.fromBufferAttribute(D,k),A[L+V+4]=r.x,A[L+V+5]=r.y,A[L+V+6]=r.z,A[L+V+7]=0),x===!0&&(r.fromBufferAttribute(O,k),A[L+V+8]=r.x,A[L+V+9]=r.y,A[L+V+10]=r.z,A[L+V+11]=O.itemSize===4?r.w:1)}}u={count:d,texture:_,size:new We(S,E)},i.set(o,u),o.addEventListener("dispose",I)}if(a.isInstancedMesh===!0&&a.morphTexture!==null)l.getUniforms().setValue(n,"morphTexture",a.morphTexture,t);else{let h=0;for(let x=0;x<c.length;x++)h+=c[x];const g=o.morphTargetsRelative?1:1-h;l.getUniforms().setValue(n,"morphTargetBaseInfluence",g),l.getUniforms().setValue(n,"morphTargetInfluences",c)}l.getUniforms().setValue(n,"morphTargetsTexture",u.texture,t),l.getUniforms().setValue(n,"morphTargetsTextureSize",u.size)}return{update:s}}function mx(n,e,t,i,r){let s=new WeakMap;function a(c){const f=r.render.frame,d=c.geometry,u=e.get(c,d);if(s.get(u)!==f&&(e.update(u),s.set(u,f)),c.isInstancedMesh&&(c.hasEventListener("dispose",l)===!1&&c.addEventListener("dispose",l),s.get(c)!==f&&(t.update(c.instanceMatrix,n.ARRAY_BUFFER),c.instanceColor!==null&&t.update(c.instanceColor,n.ARRAY_BUFFER),s.set(c,f))),c.isSkinnedMesh){const h=c.skeleton;s.get(h)!==f&&(h.update(),s.set(h,f))}return u}function o(){s=new WeakMap}function l(c){const f=c.target;f.removeEventListener("dispose",l),i.releaseStatesOfObject(f),t.remove(f.instanceMatrix),f.instanceColor!==null&&t.remove(f.instanceColor)}return{update:a,dispose:o}}const gx={[hd]:"LINEAR_TONE_MAPPING",[pd]:"REINHARD_TONE_MAPPING",[md]:"CINEON_TONE_MAPPING",[gd]:"ACES_FILMIC_TONE_MAPPING",[vd]:"AGX_TONE_MAPPING",[xd]:"NEUTRAL_TONE_MAPPING",[_d]:"CUSTOM_TONE_MAPPING"};function _x(n,e,t,i,r,s){const a=new Dn(e,t,{type:n,depthBuffer:r,stencilBuffer:s,samples:i?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1});let o=null,l=null,c=null;const f=new Xn;f.setAttribute("position",new Fn([-1,3,0,-1,-1,0,3,-1,0],3)),f.setAttribute("uv",new Fn([0,2,0,0,2,0],2));const d=new H_({uniforms:{tDiffuse:{value:null}},vertexShader:`
			precision highp float;

			uniform mat4 modelViewMatrix;
			uniform mat4 projectionMatrix;

			attribute vec3 position;
			attribute vec2 uv;

			varying vec2 vUv;

			void main() {
				vUv = uv;
				gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
			}`,fragmentShader:`
			precision highp float;

			uniform sampler2D tDiffuse;

			varying vec2 vUv;

			#include <tonemapping_pars_fragment>
			#include <colorspace_pars_fragment>

			void main() {
				gl_FragColor = texture2D( tDiffuse, vUv );

				#ifdef LINEAR_TONE_MAPPING
					gl_FragColor.rgb = LinearToneMapping( gl_FragColor.rgb );
				#elif defined( REINHARD_TONE_MAPPING )
					gl_FragColor.rgb = ReinhardToneMapping( gl_FragColor.rgb );
				#elif defined( CINEON_TONE_MAPPING )
					gl_FragColor.rgb = CineonToneMapping( gl_FragColor.rgb );
				#elif defined( ACES_FILMIC_TONE_MAPPING )
					gl_FragColor.rgb = ACESFilmicToneMapping( gl_FragColor.rgb );
				#elif defined( AGX_TONE_MAPPING )
					gl_FragColor.rgb = AgXToneMapping( gl_FragColor.rgb );
				#elif defined( NEUTRAL_TONE_MAPPING )
					gl_FragColor.rgb = NeutralToneMapping( gl_FragColor.rgb );
				#elif defined( CUSTOM_TONE_MAPPING )
					gl_FragColor.rgb = CustomToneMapping( gl_FragColor.rgb );
				#endif

				#ifdef SRGB_TRANSFER
					gl_FragColor = sRGBTransferOETF( gl_FragColor );
				#endif
			}`,depthTest:!1,depthWrite:!1}),u=new yi(f,d),h=new W_(-1,1,1,-1,0,1);let g=null,x=null,m=!1,p,v=null,y=[],S=!1;this.setSize=function(E,A){a.setSize(E,A),o!==null&&o.setSize(E,A),l!==null&&l.setSize(E,A);for(let _=0;_<y.length;_++){const b=y[_];b.setSize&&b.setSize(E,A)}},this.setEffects=function(E){y=E,S=y.length>0&&y[0].isRenderPass===!0;const A=a.width,_=a.height;y.length>0&&o===null&&(o=new Dn(A,_,{type:Wn,depthBuffer:!1,stencilBuffer:!1}),l=new Dn(A,_,{type:Wn,depthBuffer:!1,stencilBuffer:!1}));const b=r===!0&&y.some(I=>I.needsDepthTexture===!0);b!==(a.depthTexture!==null)&&(b===!0&&c===null&&(c=new ns(A,_),s===!0&&(c.format=Oi,c.type=Wr)),a.dispose(),a.depthTexture=b?c:null,a.resolveDepthBuffer=b,a.storeMultisampledDepthBuffer=b);for(let I=0;I<y.length;I++){const R=y[I];R.setSize&&R.setSize(A,_),b&&R.needsDepthTexture===!0&&R.setDepthTexture&&R.setDepthTexture(c)}},this.begin=function(E,A){if(m||E.toneMapping===pi&&y.length===0)return!1;if(v=A,A!==null){const _=A.width,b=A.height;(a.width!==_||a.height!==b)&&this.setSize(_,b)}return S===!1&&E.setRenderTarget(a),p=E.toneMapping,E.toneMapping=pi,!0},this.hasRenderPass=function(){return S},this.end=function(E,A){E.toneMapping=p,m=!0;let _=a,b=o;for(let I=0;I<y.length;I++){const R=y[I];R.enabled!==!1&&(R.render(E,b,_,A),R.needsSwap!==!1&&(_=b,b=b===o?l:o))}if(g!==E.outputColorSpace||x!==E.toneMapping){g=E.outputColorSpace,x=E.toneMapping,d.defines={},Ye.getTransfer(g)===nt&&(d.defines.SRGB_TRANSFER="");const I=gx[x];I&&(d.defines[I]=""),d.needsUpdate=!0}d.uniforms.tDiffuse.value=_.texture,E.setRenderTarget(v),E.render(u,h),v=null,m=!1},this.isCompositing=function(){return m},this.dispose=function(){a.dispose(),o!==null&&o.dispose(),l!==null&&l.dispose(),f.dispose(),d.dispose()}}const wh=new tn,Th=new ns(1,1),Ah=new lh(1),Rh=new Bd,Ch=new __,Ph=new oh,Lh=[],Dh=[],Ih=new Float32Array(16),Nh=new Float32Array(9),Uh=new Float32Array(4);function ls(n,e,t){const i=n[0];if(i<=0||i>0)return n;const r=e*t;let s=Lh[r];if(s===void 0&&(s=new Float32Array(r),Lh[r]=s),e!==0){i.toArray(s,0);for(let a=1,o=0;a!==e;++a)o+=t,n[a].toArray(s,o)}return s}function Tt(n,e){if(n.length!==e.length)return!1;for(let t=0,i=n.length;t<i;t++)if(n[t]!==e[t])return!1;return!0}function At(n,e){for(let t=0,i=e.length;t<i;t++)n[t]=e[t]}function Eo(n,e){let t=Dh[e];t===void 0&&(t=new Int32Array(e),Dh[e]=t);for(let i=0;i!==e;++i)t[i]=n.allocateTextureUnit();return t}function vx(n,e){const t=this.cache;t[0]!==e&&(n.uniform1f(this.addr,e),t[0]=e)}function xx(n,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(n.uniform2f(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(Tt(t,e))return;n.uniform2fv(this.addr,e),At(t,e)}}function Sx(n,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(n.uniform3f(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else if(e.r!==void 0)(t[0]!==e.r||t[1]!==e.g||t[2]!==e.b)&&(n.uniform3f(this.addr,e.r,e.g,e.b),t[0]=e.r,t[1]=e.g,t[2]=e.b);else{if(Tt(t,e))return;n.uniform3fv(this.addr,e),At(t,e)}}function Mx(n,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(n.uniform4f(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(Tt(t,e))return;n.uniform4fv(this.addr,e),At(t,e)}}function yx(n,e){const t=this.cache,i=e.elements;if(i===void 0){if(Tt(t,e))return;n.uniformMatrix2fv(this.addr,!1,e),At(t,e)}else{if(Tt(t,i))return;Uh.set(i),n.uniformMatrix2fv(this.addr,!1,Uh),At(t,i)}}function bx(n,e){const t=this.cache,i=e.elements;if(i===void 0){if(Tt(t,e))return;n.uniformMatrix3fv(this.addr,!1,e),At(t,e)}else{if(Tt(t,i))return;Nh.set(i),n.uniformMatrix3fv(this.addr,!1,Nh),At(t,i)}}function Ex(n,e){const t=this.cache,i=e.elements;if(i===void 0){if(Tt(t,e))return;n.uniformMatrix4fv(this.addr,!1,e),At(t,e)}else{if(Tt(t,i))return;Ih.set(i),n.uniformMatrix4fv(this.addr,!1,Ih),At(t,i)}}function wx(n,e){const t=this.cache;t[0]!==e&&(n.uniform1i(this.addr,e),t[0]=e)}function Tx(n,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(n.uniform2i(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(Tt(t,e))return;n.uniform2iv(this.addr,e),At(t,e)}}function Ax(n,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(n.uniform3i(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else{if(Tt(t,e))return;n.uniform3iv(this.addr,e),At(t,e)}}function Rx(n,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(n.uniform4i(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(Tt(t,e))return;n.uniform4iv(this.addr,e),At(t,e)}}function Cx(n,e){const t=this.cache;t[0]!==e&&(n.uniform1ui(this.addr,e),t[0]=e)}function Px(n,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(n.uniform2ui(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(Tt(t,e))return;n.uniform2uiv(this.addr,e),At(t,e)}}function Lx(n,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(n.uniform3ui(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else{if(Tt(t,e))return;n.uniform3uiv(this.addr,e),At(t,e)}}function Dx(n,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(n.uniform4ui(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(Tt(t,e))return;n.uniform4uiv(this.addr,e),At(t,e)}}function wo(n){return n.version===0&&(n.compareFunction=Ld,n.needsUpdate=!0),n}function Ix(n,e,t){const i=this.cache,r=t.allocateTextureUnit();i[0]!==r&&(n.uniform1i(this.addr,r),i[0]=r);let s;this.type===n.SAMPLER_2D_SHADOW?s=wo(Th):s=wh,t.setTexture2D(e||s,r)}function Nx(n,e,t){const i=this.cache,r=t.allocateTextureUnit();i[0]!==r&&(n.uniform1i(this.addr,r),i[0]=r),t.setTexture3D(e||Ch,r)}function Ux(n,e,t){const i=this.cache,r=t.allocateTextureUnit();i[0]!==r&&(n.uniform1i(this.addr,r),i[0]=r);let s;this.type===n.SAMPLER_CUBE_SHADOW?s=wo(Ah):s=Ph,t.setTextureCube(e||s,r)}function Fx(n,e,t){const i=this.cache,r=t.allocateTextureUnit();i[0]!==r&&(n.uniform1i(this.addr,r),i[0]=r),t.setTexture2DArray(e||Rh,r)}function Ox(n){switch(n){case 5126:return vx;case 35664:return xx;case 35665:return Sx;case 35666:return Mx;case 35674:return yx;case 35675:return bx;case 35676:return Ex;case 5124:case 35670:return wx;case 35667:case 35671:return Tx;case 35668:case 35672:return Ax;case 35669:case 35673:return Rx;case 5125:return Cx;case 36294:return Px;case 36295:return Lx;case 36296:return Dx;case 35678:case 36198:case 36298:case 36306:case 35682:return Ix;case 35679:case 36299:case 36307:return Nx;case 35680:case 36300:case 36308:case 36293:return Ux;case 36289:case 36303:case 36311:case 36292:return Fx}}function Bx(n,e){n.uniform1fv(this.addr,e)}function kx(n,e){const t=ls(e,this.size,2);n.uniform2fv(this.addr,t)}function zx(n,e){const t=ls(e,this.size,3);n.uniform3fv(this.addr,t)}function Hx(n,e){const t=ls(e,this.size,4);n.uniform4fv(this.addr,t)}function Gx(n,e){const t=ls(e,this.size,4);n.uniformMatrix2fv(this.addr,!1,t)}function Vx(n,e){const t=ls(e,this.size,9);n.uniformMatrix3fv(this.addr,!1,t)}function Wx(n,e){const t=ls(e,this.size,16);n.uniformMatrix4fv(this.addr,!1,t)}function $x(n,e){n.uniform1iv(this.addr,e)}function Xx(n,e){n.uniform2iv(this.addr,e)}function qx(n,e){n.uniform3iv(this.addr,e)}function Yx(n,e){n.uniform4iv(this.addr,e)}function Kx(n,e){n.uniform1uiv(this.addr,e)}function Zx(n,e){n.uniform2uiv(this.addr,e)}function Jx(n,e){n.uniform3uiv(this.addr,e)}function Qx(n,e){n.uniform4uiv(this.addr,e)}function jx(n,e,t){const i=this.cache,r=e.length,s=Eo(t,r);Tt(i,s)||(n.uniform1iv(this.addr,s),At(i,s));let a;this.type===n.SAMPLER_2D_SHADOW?a=wo(Th):a=wh;for(let o=0;o!==r;++o)t.setTexture2D(e[o]||a,s[o])}function eS(n,e,t){const i=this.cache,r=e.length,s=Eo(t,r);Tt(i,s)||(n.uniform1iv(this.addr,s),At(i,s));for(let a=0;a!==r;++a)t.setTexture3D(e[a]||Ch,s[a])}function tS(n,e,t){const i=this.cache,r=e.length,s=Eo(t,r);Tt(i,s)||(n.uniform1iv(this.addr,s),At(i,s));let a;this.type===n.SAMPLER_CUBE_SHADOW?a=wo(Ah):a=Ph;for(let o=0;o!==r;++o)t.setTextureCube(e[o]||a,s[o])}function nS(n,e,t){const i=this.cache,r=e.length,s=Eo(t,r);Tt(i,s)||(n.uniform1iv(this.addr,s),At(i,s));for(let a=0;a!==r;++a)t.setTexture2DArray(e[a]||Rh,s[a])}function iS(n){switch(n){case 5126:return Bx;case 35664:return kx;case 35665:return zx;case 35666:return Hx;case 35674:return Gx;case 35675:return Vx;case 35676:return Wx;case 5124:case 35670:return $x;case 35667:case 35671:return Xx;case 35668:case 35672:return qx;case 35669:case 35673:return Yx;case 5125:return Kx;case 36294:return Zx;case 36295:return Jx;case 36296:return Qx;case 35678:case 36198:case 36298:case 36306:case 35682:return jx;case 35679:case 36299:case 36307:return eS;case 35680:case 36300:case 36308:case 36293:return tS;case 36289:case 36303:case 36311:case 36292:return nS}}class rS{constructor(e,t,i){this.id=e,this.addr=i,this.cache=[],this.type=t.type,this.setValue=Ox(t.type)}}class sS{constructor(e,t,i){this.id=e,this.addr=i,this.cache=[],this.type=t.type,this.size=t.size,this.setValue=iS(t.type)}}class aS{constructor(e){this.id=e,this.seq=[],this.map={}}setValue(e,t,i){const r=this.seq;for(let s=0,a=r.length;s!==a;++s){const o=r[s];o.setValue(e,t[o.id],i)}}}const cu=/(\w+)(\])?(\[|\.)?/g;function Fh(n,e){n.seq.push(e),n.map[e.id]=e}function oS(n,e,t){const i=n.name,r=i.length;for(cu.lastIndex=0;;){const s=cu.exec(i),a=cu.lastIndex;let o=s[1];const l=s[2]==="]",c=s[3];if(l&&(o=o|0),c===void 0||c==="["&&a+2===r){Fh(t,c===void 0?new rS(o,n,e):new sS(o,n,e));break}else{let d=t.map[o];d===void 0&&(d=new aS(o),Fh(t,d)),t=d}}}class To{constructor(e,t){this.seq=[],this.map={};const i=e.getProgramParameter(t,e.ACTIVE_UNIFORMS);for(let a=0;a<i;++a){const o=e.getActiveUniform(t,a),l=e.getUniformLocation(t,o.name);oS(o,l,this)}const r=[],s=[];for(const a of this.seq)a.type===e.SAMPLER_2D_SHADOW||a.type===e.SAMPLER_CUBE_SHADOW||a.type===e.SAMPLER_2D_ARRAY_SHADOW?r.push(a):s.push(a);r.length>0&&(this.seq=r.concat(s))}setValue(e,t,i,r){const s=this.map[t];s!==void 0&&s.setValue(e,i,r)}setOptional(e,t,i){const r=t[i];r!==void 0&&this.setValue(e,i,r)}static upload(e,t,i,r){for(let s=0,a=t.length;s!==a;++s){const o=t[s],l=i[o.id];l.needsUpdate!==!1&&o.setValue(e,l.value,r)}}static seqWithValue(e,t){const i=[];for(let r=0,s=e.length;r!==s;++r){const a=e[r];a.id in t&&i.push(a)}return i}}function Oh(n,e,t){const i=n.createShader(e);return n.shaderSource(i,t),n.compileShader(i),i}const lS=37297;let cS=0;function uS(n,e){const t=n.split(`
`),i=[],r=Math.max(e-6,0),s=Math.min(e+6,t.length);for(let a=r;a<s;a++){const o=a+1;i.push(`${o===e?">":" "} ${o}: ${t[a]}`)}return i.join(`
`)}const Bh=new Fe;function fS(n){Ye._getMatrix(Bh,Ye.workingColorSpace,n);const e=`mat3( ${Bh.elements.map(t=>t.toFixed(4))} )`;switch(Ye.getTransfer(n)){case Ga:return[e,"LinearTransferOETF"];case nt:return[e,"sRGBTransferOETF"];default:return Le("WebGLProgram: Unsupported color space: ",n),[e,"LinearTransferOETF"]}}function kh(n,e,t){const i=n.getShaderParameter(e,n.COMPILE_STATUS),s=(n.getShaderInfoLog(e)||"").trim();if(i&&s==="")return"";const a=/ERROR: 0:(\d+)/.exec(s);if(a){const o=parseInt(a[1]);return t.toUpperCase()+`

`+s+`

`+uS(n.getShaderSource(e),o)}else return s}function dS(n,e){const t=fS(e);return[`vec4 ${n}( vec4 value ) {`,`	return ${t[1]}( vec4( ${t[0]} * value.rgb, value.a ) );`,"}"].join(`
`)}const hS={[hd]:"Linear",[pd]:"Reinhard",[md]:"Cineon",[gd]:"ACESFilmic",[vd]:"AgX",[xd]:"Neutral",[_d]:"Custom"};function pS(n,e){const t=hS[e];return t===void 0?(Le("WebGLProgram: Unsupported toneMapping:",e),"vec3 "+n+"( vec3 color ) { return LinearToneMapping( color ); }"):"vec3 "+n+"( vec3 color ) { return "+t+"ToneMapping( color ); }"}const Ao=new N;function mS(){Ye.getLuminanceCoefficients(Ao);const n=Ao.x.toFixed(4),e=Ao.y.toFixed(4),t=Ao.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${n}, ${e}, ${t} );`,"	return dot( weights, rgb );","}"].join(`
`)}function gS(n){return[n.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",n.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(Qs).join(`
`)}function _S(n){const e=[];for(const t in n){const i=n[t];i!==!1&&e.push("#define "+t+" "+i)}return e.join(`
`)}function vS(n,e){const t={},i=n.getProgramParameter(e,n.ACTIVE_ATTRIBUTES);for(let r=0;r<i;r++){const s=n.getActiveAttrib(e,r),a=s.name;let o=1;s.type===n.FLOAT_MAT2&&(o=2),s.type===n.FLOAT_MAT3&&(o=3),s.type===n.FLOAT_MAT4&&(o=4),t[a]={type:s.type,location:n.getAttribLocation(e,a),locationSize:o}}return t}function Qs(n){return n!==""}function zh(n,e){const t=e.numSpotLightShadows+e.numSpotLightMaps-e.numSpotLightShadowsWithMaps;return n.replace(/NUM_SUN_LIGHTS/g,e.numSunLights).replace(/NUM_DIR_LIGHTS/g,e.numDirLights).replace(/NUM_SPOT_LIGHTS/g,e.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,e.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,t).replace(/NUM_RECT_AREA_LIGHTS/g,e.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,e.numPointLights).replace(/NUM_HEMI_LIGHTS/g,e.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,e.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,e.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,e.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,e.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,e.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,e.numLightProbeGrids)}function Hh(n,e){return n.replace(/NUM_CLIPPING_PLANES/g,e.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,e.numClippingPlanes-e.numClipIntersection)}const xS=/^[ \t]*#include +<([\w\d./]+)>/gm;function uu(n){return n.replace(xS,SS)}function SS(n,e){const t=ze[e];if(t===void 0)throw new Error("THREE.WebGLProgram: Can not resolve #include <"+e+">");return uu(t)}const MS=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function Gh(n){return n.replace(MS,yS)}function yS(n,e,t,i){let r="";for(let s=parseInt(e);s<parseInt(t);s++)r+=i.replace(/\[\s*i\s*\]/g,"[ "+s+" ]").replace(/UNROLLED_LOOP_INDEX/g,s);return r}function Vh(n){let e=`precision ${n.precision} float;
	precision ${n.precision} int;
	precision ${n.precision} sampler2D;
	precision ${n.precision} samplerCube;
	precision ${n.precision} sampler3D;
	precision ${n.precision} sampler2DArray;
	precision ${n.precision} sampler2DShadow;
	precision ${n.precision} samplerCubeShadow;
	precision ${n.precision} sampler2DArrayShadow;
	precision ${n.precision} isampler2D;
	precision ${n.precision} isampler3D;
	precision ${n.precision} isamplerCube;
	precision ${n.precision} isampler2DArray;
	precision ${n.precision} usampler2D;
	precision ${n.precision} usampler3D;
	precision ${n.precision} usamplerCube;
	precision ${n.precision} usampler2DArray;
	`;return n.precision==="highp"?e+=`
#define HIGH_PRECISION`:n.precision==="mediump"?e+=`
#define MEDIUM_PRECISION`:n.precision==="lowp"&&(e+=`
#define LOW_PRECISION`),e}const bS={[Ia]:"SHADOWMAP_TYPE_PCF",[Bs]:"SHADOWMAP_TYPE_VSM"};function ES(n){return bS[n.shadowMapType]||"SHADOWMAP_TYPE_BASIC"}const wS={[Hs]:"ENVMAP_MODE_REFRACTION"};function TS(n){return n.envMap===!1?"ENVMAP_MODE_REFLECTION":wS[n.envMapMode]||"ENVMAP_MODE_REFLECTION"}const AS={[dd]:"ENVMAP_BLENDING_MULTIPLY",[Xg]:"ENVMAP_BLENDING_MIX",[qg]:"ENVMAP_BLENDING_ADD"};function RS(n){return n.envMap===!1?"ENVMAP_BLENDING_NONE":AS[n.combine]||"ENVMAP_BLENDING_NONE"}function CS(n,e,t,i){const r=n.getContext(),s=t.defines;let a=t.vertexShader,o=t.fragmentShader;const l=ES(t),c=t.envMapPMREM===!0?"ENVMAP_TYPE_PMREM":"ENVMAP_TYPE_CUBE",f=TS(t),d=RS(t),u=gS(t),h=_S(s),g=r.createProgram();let x,m,p=t.glslVersion?"#version "+t.glslVersion+`
`:"";t.isRawShaderMaterial?(x=["#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,h].filter(Qs).join(`
`),x.length>0&&(x+=`
`),m=["#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,h].filter(Qs).join(`
`),m.length>0&&(m+=`
`)):(x=[Vh(t),"#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,h,t.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",t.batching?"#define USE_BATCHING":"",t.batchingColor?"#define USE_BATCHING_COLOR":"",t.instancing?"#define USE_INSTANCING":"",t.instancingColor?"#define USE_INSTANCING_COLOR":"",t.instancingMorph?"#define USE_INSTANCING_MORPH":"",t.useFog&&t.fog?"#define USE_FOG":"",t.useFog&&t.fogExp2?"#define FOG_EXP2":"",t.map?"#define USE_MAP":"",t.envMap?"#define USE_ENVMAP":"",t.envMap?"#define "+f:"",t.lightMap?"#define USE_LIGHTMAP":"",t.aoMap?"#define USE_AOMAP":"",t.bumpMap?"#define USE_BUMPMAP":"",t.normalMap?"#define USE_NORMALMAP":"",t.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",t.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",t.displacementMap?"#define USE_DISPLACEMENTMAP":"",t.emissiveMap?"#define USE_EMISSIVEMAP":"",t.anisotropy?"#define USE_ANISOTROPY":"",t.anisotropyMap?"#define USE_ANISOTROPYMAP":"",t.clearcoatMap?"#define USE_CLEARCOATMAP":"",t.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",t.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",t.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",t.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",t.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",t.specularMap?"#define USE_SPECULARMAP":"",t.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",t.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",t.roughnessMap?"#define USE_ROUGHNESSMAP":"",t.metalnessMap?"#define USE_METALNESSMAP":"",t.alphaMap?"#define USE_ALPHAMAP":"",t.alphaHash?"#define USE_ALPHAHASH":"",t.transmission?"#define USE_TRANSMISSION":"",t.transmissionMap?"#define USE_TRANSMISSIONMAP":"",t.thicknessMap?"#define USE_THICKNESSMAP":"",t.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",t.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",t.mapUv?"#define MAP_UV "+t.mapUv:"",t.alphaMapUv?"#define ALPHAMAP_UV "+t.alphaMapUv:"",t.lightMapUv?"#define LIGHTMAP_UV "+t.lightMapUv:"",t.aoMapUv?"#define AOMAP_UV "+t.aoMapUv:"",t.emissiveMapUv?"#define EMISSIVEMAP_UV "+t.emissiveMapUv:"",t.bumpMapUv?"#define BUMPMAP_UV "+t.bumpMapUv:"",t.normalMapUv?"#define NORMALMAP_UV "+t.normalMapUv:"",t.displacementMapUv?"#define DISPLACEMENTMAP_UV "+t.displacementMapUv:"",t.metalnessMapUv?"#define METALNESSMAP_UV "+t.metalnessMapUv:"",t.roughnessMapUv?"#define ROUGHNESSMAP_UV "+t.roughnessMapUv:"",t.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+t.anisotropyMapUv:"",t.clearcoatMapUv?"#define CLEARCOATMAP_UV "+t.clearcoatMapUv:"",t.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+t.clearcoatNormalMapUv:"",t.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+t.clearcoatRoughnessMapUv:"",t.diffuseRoughnessMapUv?"#define DIFFUSE_ROUGHNESSMAP_UV "+t.diffuseRoughnessMapUv:"",t.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+t.iridescenceMapUv:"",t.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+t.iridescenceThicknessMapUv:"",t.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+t.sheenColorMapUv:"",t.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+t.sheenRoughnessMapUv:"",t.specularMapUv?"#define SPECULARMAP_UV "+t.specularMapUv:"",t.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+t.specularColorMapUv:"",t.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+t.specularIntensityMapUv:"",t.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+t.transmissionMapUv:"",t.thicknessMapUv?"#define THICKNESSMAP_UV "+t.thicknessMapUv:"",t.vertexTangents&&t.flatShading===!1?"#define USE_TANGENT":"",t.vertexNormals?"#define HAS_NORMAL":"",t.vertexColors?"#define USE_COLOR":"",t.vertexAlphas?"#define USE_COLOR_ALPHA":"",t.vertexUv1s?"#define USE_UV1":"",t.vertexUv2s?"#define USE_UV2":"",t.vertexUv3s?"#define USE_UV3":"",t.pointsUvs?"#define USE_POINTS_UV":"",t.flatShading?"#define FLAT_SHADED":"",t.skinning?"#define USE_SKINNING":"",t.morphTargets?"#define USE_MORPHTARGETS":"",t.morphNormals&&t.flatShading===!1?"#define USE_MORPHNORMALS":"",t.morphColors?"#define USE_MORPHCOLORS":"",t.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+t.morphTextureStride:"",t.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+t.morphTargetsCount:"",t.doubleSided?"#define DOUBLE_SIDED":"",t.flipSided?"#define FLIP_SIDED":"",t.shadowMapEnabled?"#define USE_SHADOWMAP":"",t.shadowMapEnabled?"#define "+l:"",t.sizeAttenuation?"#define USE_SIZEATTENUATION":"",t.numLightProbes>0?"#define USE_LIGHT_PROBES":"",t.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",t.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(Qs).join(`
`),m=[Vh(t),"#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,h,t.useFog&&t.fog?"#define USE_FOG":"",t.useFog&&t.fogExp2?"#define FOG_EXP2":"",t.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",t.map?"#define USE_MAP":"",t.matcap?"#define USE_MATCAP":"",t.envMap?"#define USE_ENVMAP":"",t.envMap?"#define "+c:"",t.envMap?"#define "+f:"",t.envMap?"#define "+d:"",t.envMapPMREM?"#define ENVMAP_MAX_LOD "+t.envMapMaxLod+".0":"",t.envMapPMREM?"#define ENVMAP_SIZE "+t.envMapSize+".0":"",t.lightMap?"#define USE_LIGHTMAP":"",t.aoMap?"#define USE_AOMAP":"",t.bumpMap?"#define USE_BUMPMAP":"",t.normalMap?"#define USE_NORMALMAP":"",t.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",t.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",t.packedNormalMap?"#define USE_PACKED_NORMALMAP":"",t.emissiveMap?"#define USE_EMISSIVEMAP":"",t.anisotropy?"#define USE_ANISOTROPY":"",t.anisotropyMap?"#define USE_ANISOTROPYMAP":"",t.clearcoat?"#define USE_CLEARCOAT":"",t.clearcoatMap?"#define USE_CLEARCOATMAP":"",t.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",t.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",t.diffuseRoughness?"#define USE_DIFFUSE_ROUGHNESS":"",t.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",t.dispersion?"#define USE_DISPERSION":"",t.retroreflection?"#define USE_RETROREFLECTION":"",t.iridescence?"#define USE_IRIDESCENCE":"",t.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",t.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",t.specularMap?"#define USE_SPECULARMAP":"",t.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",t.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",t.roughnessMap?"#define USE_ROUGHNESSMAP":"",t.metalnessMap?"#define USE_METALNESSMAP":"",t.alphaMap?"#define USE_ALPHAMAP":"",t.alphaTest?"#define USE_ALPHATEST":"",t.alphaHash?"#define USE_ALPHAHASH":"",t.sheen?"#define USE_SHEEN":"",t.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",t.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",t.transmission?"#define USE_TRANSMISSION":"",t.transmissionMap?"#define USE_TRANSMISSIONMAP":"",t.thicknessMap?"#define USE_THICKNESSMAP":"",t.vertexTangents&&t.flatShading===!1?"#define USE_TANGENT":"",t.vertexColors||t.instancingColor?"#define USE_COLOR":"",t.vertexAlphas||t.batchingColor?"#define USE_COLOR_ALPHA":"",t.vertexUv1s?"#define USE_UV1":"",t.vertexUv2s?"#define USE_UV2":"",t.vertexUv3s?"#define USE_UV3":"",t.pointsUvs?"#define USE_POINTS_UV":"",t.gradientMap?"#define USE_GRADIENTMAP":"",t.flatShading?"#define FLAT_SHADED":"",t.doubleSided?"#define DOUBLE_SIDED":"",t.flipSided?"#define FLIP_SIDED":"",t.shadowMapEnabled?"#define USE_SHADOWMAP":"",t.shadowMapEnabled?"#define "+l:"",t.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",t.numLightProbes>0?"#define USE_LIGHT_PROBES":"",t.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",t.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",t.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",t.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",t.toneMapping!==pi?"#define TONE_MAPPING":"",t.toneMapping!==pi?ze.tonemapping_pars_fragment:"",t.toneMapping!==pi?pS("toneMapping",t.toneMapping):"",t.dithering?"#define DITHERING":"",t.opaque?"#define OPAQUE":"",ze.colorspace_pars_fragment,dS("linearToOutputTexel",t.outputColorSpace),mS(),t.useDepthPacking?"#define DEPTH_PACKING "+t.depthPacking:"",`
`].filter(Qs).join(`
`)),a=uu(a),a=zh(a,t),a=Hh(a,t),o=uu(o),o=zh(o,t),o=Hh(o,t),a=Gh(a),o=Gh(o),t.isRawShaderMaterial!==!0&&(p=`#version 300 es
`,x=[u,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+x,m=["#define varying in",t.glslVersion===Dc?"":"layout(location = 0) out highp vec4 pc_fragColor;",t.glslVersion===Dc?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+m);const v=p+x+a,y=p+m+o,S=Oh(r,r.VERTEX_SHADER,v),E=Oh(r,r.FRAGMENT_SHADER,y);r.attachShader(g,S),r.attachShader(g,E),t.index0AttributeName!==void 0?r.bindAttribLocation(g,0,t.index0AttributeName):t.hasPositionAttribute===!0&&r.bindAttribLocation(g,0,"position"),r.linkProgram(g);function A(R){if(n.debug.checkShaderErrors){const P=r.getProgramInfoLog(g)||"",D=r.getShaderInfoLog(S)||"",O=r.getShaderInfoLog(E)||"",L=P.trim(),k=D.trim(),V=O.trim();let W=!0,te=!0;if(r.getProgramParameter(g,r.LINK_STATUS)===!1)if(W=!1,typeof n.debug.onShaderError=="function")n.debug.onShaderError(r,g,S,E);else{const X=kh(r,S,"vertex"),j=kh(r,E,"fragment");Qe("WebGLProgram: Shader Error "+r.getError()+" - VALIDATE_STATUS "+r.getProgramParameter(g,r.VALIDATE_STATUS)+`

Material Name: `+R.name+`
Material Type: `+R.type+`

Program Info Log: `+L+`
`+X+`
`+j)}else L!==""?Le("WebGLProgram: Program Info Log:",L):(k===""||V==="")&&(te=!1);te&&(R.diagnostics={runnable:W,programLog:L,vertexShader:{log:k,prefix:x},fragmentShader:{log:V,prefix:m}})}r.deleteShader(S),r.deleteShader(E),_=new To(r,g),b=vS(r,g)}let _;this.getUniforms=function(){return _===void 0&&A(this),_};let b;this.getAttributes=function(){return b===void 0&&A(this),b};let I=t.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return I===!1&&(I=r.getProgramParameter(g,lS)),I},this.destroy=function(){i.releaseStatesOfProgram(this),r.deleteProgram(g),this.program=void 0},this.type=t.shaderType,this.name=t.shaderName,this.id=cS++,this.cacheKey=e,this.usedTimes=1,this.program=g,this.vertexShader=S,this.fragmentShader=E,this}let PS=0;class LS{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(e,t,i){const r=this._getShaderCacheForMaterial(e);return r.has(t)===!1&&(r.add(t),t.usedTimes++),r.has(i)===!1&&(r.add(i),i.usedTimes++),this}remove(e){const t=this.materialCache.get(e);for(const i of t)i.usedTimes--,i.usedTimes===0&&this.shaderCache.delete(i.code);return this.materialCache.delete(e),this}getVertexShaderStage(e){return this._getShaderStage(e.vertexShader)}getFragmentShaderStage(e){return this._getShaderStage(e.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(e){const t=this.materialCache;let i=t.get(e);return i===void 0&&(i=new Set,t.set(e,i)),i}_getShaderStage(e){const t=this.shaderCache;let i=t.get(e);return i===void 0&&(i=new DS(e),t.set(e,i)),i}}class DS{constructor(e){this.id=PS++,this.code=e,this.usedTimes=0}}function IS(n){return n===hr||n===ka||n===za}function NS(n,e,t,i,r,s){const a=new Hd,o=new LS,l=new Set,c=[],f=new Map,d=i.logarithmicDepthBuffer,u={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distance",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function h(_){return l.add(_),_===0?"uv":`uv${_}`}function g(_,b,I,R,P,D){const O=R.fog,L=P.geometry,k=_.isMeshStandardMaterial||_.isMeshLambertMaterial||_.isMeshPhongMaterial?R.environment:null,V=_.isMeshStandardMaterial||_.isMeshLambertMaterial&&!_.envMap||_.isMeshPhongMaterial&&!_.envMap,W=e.get(_.envMap||k,V),te=u[_.type];let X=i.precision;_.precision!==null&&(X=i.getMaxPrecision(_.precision),X!==_.precision&&Le("WebGLProgram.getParameters:",_.precision,"not supported, using",X,"instead."));const j=L.morphAttributes.position||L.morphAttributes.normal||L.morphAttributes.color,ee=j!==void 0?j.length:0;let Se=0;L.morphAttributes.position!==void 0&&(Se=1),L.morphAttributes.normal!==void 0&&(Se=2),L.morphAttributes.color!==void 0&&(Se=3);let De,Z,fe,xe;if(te){const _e=Kn[te];De=_e.vertexShader,Z=_e.fragmentShader}else{De=_.vertexShader,Z=_.fragmentShader;const _e=o.getVertexShaderStage(_),rt=o.getFragmentShaderStage(_);o.update(_,_e,rt),fe=_e.id,xe=rt.id}const Ae=n.getRenderTarget(),ge=n.state.buffers.depth.getReversed(),Ie=P.isInstancedMesh===!0,_t=P.isBatchedMesh===!0,Re=!!_.map,Ke=!!_.matcap,st=!!W,$e=st&&W.isPMREMTexture===!0,Gt=!!_.aoMap,Lt=!!_.lightMap,cn=!!_.bumpMap&&_.wireframe===!1,pt=!!_.normalMap,ai=!!_.displacementMap,Ut=!!_.emissiveMap,An=!!_.metalnessMap,Rn=!!_.roughnessMap,Cn=_.anisotropy>0,B=_.clearcoat>0,Pn=_.diffuseRoughness>0,ft=_.dispersion>0,dt=_.retroreflectivity>0,pe=_.iridescence>0,Dt=_.sheen>0,Ce=_.transmission>0,Ne=Cn&&!!_.anisotropyMap,C=B&&!!_.clearcoatMap,w=B&&!!_.clearcoatNormalMap,H=B&&!!_.clearcoatRoughnessMap,ne=Pn&&!!_.diffuseRoughnessMap,Q=pe&&!!_.iridescenceMap,ae=pe&&!!_.iridescenceThicknessMap,de=Dt&&!!_.sheenColorMap,Y=Dt&&!!_.sheenRoughnessMap,K=!!_.specularMap,le=!!_.specularColorMap,U=!!_.specularIntensityMap,J=Ce&&!!_.transmissionMap,q=Ce&&!!_.thicknessMap,ce=!!_.gradientMap,se=!!_.alphaMap,oe=_.alphaTest>0,we=!!_.alphaHash,Ge=!!_.extensions;let ie=pi;_.toneMapped&&(Ae===null||Ae.isXRRenderTarget===!0)&&(ie=n.toneMapping);const Te=$e?W.isCompressedCubeTexture?W.image[0].mipmaps:W.mipmaps:null,ke={shaderID:te,shaderType:_.type,shaderName:_.name,vertexShader:De,fragmentShader:Z,defines:_.defines,customVertexShaderID:fe,customFragmentShaderID:xe,isRawShaderMaterial:_.isRawShaderMaterial===!0,glslVersion:_.glslVersion,precision:X,batching:_t,batchingColor:_t&&P._colorsTexture!==null,instancing:Ie,instancingColor:Ie&&P.instanceColor!==null,instancingMorph:Ie&&P.morphTexture!==null,outputColorSpace:Ae===null?n.outputColorSpace:Ae.isXRRenderTarget===!0?Ae.texture.colorSpace:Ye.workingColorSpace,alphaToCoverage:!!_.alphaToCoverage,map:Re,matcap:Ke,envMap:st,envMapMode:st&&W.mapping,envMapPMREM:$e,envMapMaxLod:$e?Te.length-1:null,envMapSize:$e?Te[0].width:null,aoMap:Gt,lightMap:Lt,bumpMap:cn,normalMap:pt,displacementMap:ai,emissiveMap:Ut,normalMapObjectSpace:pt&&_.normalMapType===Zg,normalMapTangentSpace:pt&&_.normalMapType===Rd,packedNormalMap:pt&&_.normalMapType===Rd&&IS(_.normalMap.format),metalnessMap:An,roughnessMap:Rn,anisotropy:Cn,anisotropyMap:Ne,clearcoat:B,clearcoatMap:C,clearcoatNormalMap:w,clearcoatRoughnessMap:H,diffuseRoughness:Pn,diffuseRoughnessMap:ne,dispersion:ft,retroreflection:dt,iridescence:pe,iridescenceMap:Q,iridescenceThicknessMap:ae,sheen:Dt,sheenColorMap:de,sheenRoughnessMap:Y,specularMap:K,specularColorMap:le,specularIntensityMap:U,transmission:Ce,transmissionMap:J,thicknessMap:q,gradientMap:ce,opaque:_.transparent===!1&&_.blending===ks&&_.alphaToCoverage===!1,alphaMap:se,alphaTest:oe,alphaHash:we,combine:_.combine,mapUv:Re&&h(_.map.channel),aoMapUv:Gt&&h(_.aoMap.channel),lightMapUv:Lt&&h(_.lightMap.channel),bumpMapUv:cn&&h(_.bumpMap.channel),normalMapUv:pt&&h(_.normalMap.channel),displacementMapUv:ai&&h(_.displacementMap.channel),emissiveMapUv:Ut&&h(_.emissiveMap.channel),metalnessMapUv:An&&h(_.metalnessMap.channel),roughnessMapUv:Rn&&h(_.roughnessMap.channel),anisotropyMapUv:Ne&&h(_.anisotropyMap.channel),clearcoatMapUv:C&&h(_.clearcoatMap.channel),clearcoatNormalMapUv:w&&h(_.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:H&&h(_.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:ne&&h(_.diffuseRoughnessMap.channel),iridescenceMapUv:Q&&h(_.iridescenceMap.channel),iridescenceThicknessMapUv:ae&&h(_.iridescenceThicknessMap.channel),sheenColorMapUv:de&&h(_.sheenColorMap.channel),sheenRoughnessMapUv:Y&&h(_.sheenRoughnessMap.channel),specularMapUv:K&&h(_.specularMap.channel),specularColorMapUv:le&&h(_.specularColorMap.channel),specularIntensityMapUv:U&&h(_.specularIntensityMap.channel),transmissionMapUv:J&&h(_.transmissionMap.channel),thicknessMapUv:q&&h(_.thicknessMap.channel),alphaMapUv:se&&h(_.alphaMap.channel),vertexTangents:!!L.attributes.tangent&&(pt||Cn),vertexNormals:!!L.attributes.normal,vertexColors:_.vertexColors,vertexAlphas:_.vertexColors===!0&&!!L.attributes.color&&L.attributes.color.itemSize===4,pointsUvs:P.isPoints===!0&&!!L.attributes.uv&&(Re||se),fog:!!O,useFog:_.fog===!0,fogExp2:!!O&&O.isFogExp2,flatShading:_.wireframe===!1&&(_.flatShading===!0||L.attributes.normal===void 0&&pt===!1&&(_.isMeshLambertMaterial||_.isMeshPhongMaterial||_.isMeshStandardMaterial||_.isMeshPhysicalMaterial)),sizeAttenuation:_.sizeAttenuation===!0,logarithmicDepthBuffer:d,reversedDepthBuffer:ge,skinning:P.isSkinnedMesh===!0,hasPositionAttribute:L.attributes.position!==void 0,morphTargets:L.morphAttributes.position!==void 0,morphNormals:L.morphAttributes.normal!==void 0,morphColors:L.morphAttributes.color!==void 0,morphTargetsCount:ee,morphTextureStride:Se,numSunLights:b.sun.length,numDirLights:b.directional.length,numPointLights:b.point.length,numSpotLights:b.spot.length,numSpotLightMaps:b.spotLightMap.length,numRectAreaLights:b.rectArea.length,numHemiLights:b.hemi.length,numSunLightShadows:b.sunShadowMap.length,numDirLightShadows:b.directionalShadowMap.length,numPointLightShadows:b.pointShadowMap.length,numSpotLightShadows:b.spotShadowMap.length,numSpotLightShadowsWithMaps:b.numSpotLightShadowsWithMaps,numLightProbes:b.numLightProbes,numLightProbeGrids:D.filter(_e=>_e.texture!==null).length,numClippingPlanes:s.numPlanes,numClipIntersection:s.numIntersection,dithering:_.dithering,shadowMapEnabled:n.shadowMap.enabled&&I.length>0,shadowMapType:n.shadowMap.type,toneMapping:ie,decodeVideoTexture:Re&&_.map.isVideoTexture===!0&&Ye.getTransfer(_.map.colorSpace)===nt,decodeVideoTextureEmissive:Ut&&_.emissiveMap.isVideoTexture===!0&&Ye.getTransfer(_.emissiveMap.colorSpace)===nt,premultipliedAlpha:_.premultipliedAlpha,doubleSided:_.side===un,flipSided:_.side===en,useDepthPacking:_.depthPacking>=0,depthPacking:_.depthPacking||0,index0AttributeName:_.index0AttributeName,extensionClipCullDistance:Ge&&_.extensions.clipCullDistance===!0&&t.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(Ge&&_.extensions.multiDraw===!0||_t)&&t.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:t.has("KHR_parallel_shader_compile"),customProgramCacheKey:_.customProgramCacheKey()};return ke.vertexUv1s=l.has(1),ke.vertexUv2s=l.has(2),ke.vertexUv3s=l.has(3),l.clear(),ke}function x(_){const b=[];if(_.shaderID?b.push(_.shaderID):(b.push(_.customVertexShaderID),b.push(_.customFragmentShaderID)),_.defines!==void 0)for(const I in _.defines)b.push(I),b.push(_.defines[I]);return _.isRawShaderMaterial===!1&&(m(b,_),p(b,_),b.push(n.outputColorSpace)),b.push(_.customProgramCacheKey),b.join()}function m(_,b){_.push(b.precision),_.push(b.outputColorSpace),_.push(b.envMapMode),_.push(b.envMapPMREM),_.push(b.envMapMaxLod),_.push(b.envMapSize),_.push(b.mapUv),_.push(b.alphaMapUv),_.push(b.lightMapUv),_.push(b.aoMapUv),_.push(b.bumpMapUv),_.push(b.normalMapUv),_.push(b.displacementMapUv),_.push(b.emissiveMapUv),_.push(b.metalnessMapUv),_.push(b.roughnessMapUv),_.push(b.anisotropyMapUv),_.push(b.clearcoatMapUv),_.push(b.clearcoatNormalMapUv),_.push(b.clearcoatRoughnessMapUv),_.push(b.diffuseRoughnessMapUv),_.push(b.iridescenceMapUv),_.push(b.iridescenceThicknessMapUv),_.push(b.sheenColorMapUv),_.push(b.sheenRoughnessMapUv),_.push(b.specularMapUv),_.push(b.specularColorMapUv),_.push(b.specularIntensityMapUv),_.push(b.transmissionMapUv),_.push(b.thicknessMapUv),_.push(b.combine),_.push(b.fogExp2),_.push(b.sizeAttenuation),_.push(b.morphTargetsCount),_.push(b.numSunLights),_.push(b.numDirLights),_.push(b.numPointLights),_.push(b.numSpotLights),_.push(b.numSpotLightMaps),_.push(b.numHemiLights),_.push(b.numRectAreaLights),_.push(b.numSunLightShadows),_.push(b.numDirLightShadows),_.push(b.numPointLightShadows),_.push(b.numSpotLightShadows),_.push(b.numSpotLightShadowsWithMaps),_.push(b.numLightProbes),_.push(b.numLightProbeGrids),_.push(b.shadowMapType),_.push(b.toneMapping),_.push(b.numClippingPlanes),_.push(b.numClipIntersection),_.push(b.depthPacking)}function p(_,b){a.disableAll(),b.instancing&&a.enable(0),b.instancingColor&&a.enable(1),b.instancingMorph&&a.enable(2),b.matcap&&a.enable(3),b.envMap&&a.enable(4),b.normalMapObjectSpace&&a.enable(5),b.normalMapTangentSpace&&a.enable(6),b.clearcoat&&a.enable(7),b.iridescence&&a.enable(8),b.alphaTest&&a.enable(9),b.vertexColors&&a.enable(10),b.vertexAlphas&&a.enable(11),b.vertexUv1s&&a.enable(12),b.vertexUv2s&&a.enable(13),b.vertexUv3s&&a.enable(14),b.vertexTangents&&a.enable(15),b.anisotropy&&a.enable(16),b.alphaHash&&a.enable(17),b.batching&&a.enable(18),b.dispersion&&a.enable(19),b.retroreflection&&a.enable(24),b.diffuseRoughness&&a.enable(25),b.batchingColor&&a.enable(20),b.gradientMap&&a.enable(21),b.packedNormalMap&&a.enable(22),b.vertexNormals&&a.enable(23),_.push(a.mask),a.disableAll(),b.fog&&a.enable(0),b.useFog&&a.enable(1),b.flatShading&&a.enable(2),b.logarithmicDepthBuffer&&a.enable(3),b.reversedDepthBuffer&&a.enable(4),b.skinning&&a.enable(5),b.morphTargets&&a.enable(6),b.morphNormals&&a.enable(7),b.morphColors&&a.enable(8),b.premultipliedAlpha&&a.enable(9),b.shadowMapEnabled&&a.enable(10),b.doubleSided&&a.enable(11),b.flipSided&&a.enable(12),b.useDepthPacking&&a.enable(13),b.dithering&&a.enable(14),b.transmission&&a.enable(15),b.sheen&&a.enable(16),b.opaque&&a.enable(17),b.pointsUvs&&a.enable(18),b.decodeVideoTexture&&a.enable(19),b.decodeVideoTextureEmissive&&a.enable(20),b.alphaToCoverage&&a.enable(21),b.numLightProbeGrids>0&&a.enable(22),b.hasPositionAttribute&&a.enable(23),_.push(a.mask)}function v(_){const b=u[_.type];let I;if(b){const R=Kn[b];I=B_.clone(R.uniforms)}else I=_.uniforms;return I}function y(_,b){let I=f.get(b);return I!==void 0?++I.usedTimes:(I=new CS(n,b,_,r),c.push(I),f.set(b,I)),I}function S(_){if(--_.usedTimes===0){const b=c.indexOf(_);c[b]=c[c.length-1],c.pop(),f.delete(_.cacheKey),_.destroy()}}function E(_){o.remove(_)}function A(){o.dispose()}return{getParameters:g,getProgramCacheKey:x,getUniforms:v,acquireProgram:y,releaseProgram:S,releaseShaderCache:E,programs:c,dispose:A}}function US(){let n=new WeakMap;function e(a){return n.has(a)}function t(a){let o=n.get(a);return o===void 0&&(o={},n.set(a,o)),o}function i(a){n.delete(a)}function r(a,o,l){n.get(a)[o]=l}function s(){n=new WeakMap}return{has:e,get:t,remove:i,update:r,dispose:s}}function FS(n,e){return n.groupOrder!==e.groupOrder?n.groupOrder-e.groupOrder:n.renderOrder!==e.renderOrder?n.renderOrder-e.renderOrder:n.material.id!==e.material.id?n.material.id-e.material.id:n.materialVariant!==e.materialVariant?n.materialVariant-e.materialVariant:n.z!==e.z?n.z-e.z:n.id-e.id}function Wh(n,e){return n.groupOrder!==e.groupOrder?n.groupOrder-e.groupOrder:n.renderOrder!==e.renderOrder?n.renderOrder-e.renderOrder:n.z!==e.z?e.z-n.z:n.id-e.id}function $h(){const n=[];let e=0;const t=[],i=[],r=[];function s(){e=0,t.length=0,i.length=0,r.length=0}function a(u){let h=0;return u.isInstancedMesh&&(h+=2),u.isSkinnedMesh&&(h+=1),h}function o(u,h,g,x,m,p){let v=n[e];return v===void 0?(v={id:u.id,object:u,geometry:h,material:g,materialVariant:a(u),groupOrder:x,renderOrder:u.renderOrder,z:m,group:p},n[e]=v):(v.id=u.id,v.object=u,v.geometry=h,v.material=g,v.materialVariant=a(u),v.groupOrder=x,v.renderOrder=u.renderOrder,v.z=m,v.group=p),e++,v}function l(u,h,g,x,m,p,v){v.reversedDepth===!0&&(m=-m);const y=o(u,h,g,x,m,p);g.transmission>0?i.push(y):g.transparent===!0?r.push(y):t.push(y)}function c(u,h,g,x,m,p){const v=o(u,h,g,x,m,p);g.transmission>0?i.unshift(v):g.transparent===!0?r.unshift(v):t.unshift(v)}function f(u,h){t.length>1&&t.sort(u||FS),i.length>1&&i.sort(h||Wh),r.length>1&&r.sort(h||Wh)}function d(){for(let u=e,h=n.length;u<h;u++){const g=n[u];if(g.id===null)break;g.id=null,g.object=null,g.geometry=null,g.material=null,g.group=null}}return{opaque:t,transmissive:i,transparent:r,init:s,push:l,unshift:c,finish:d,sort:f}}function OS(){let n=new WeakMap;function e(i,r){const s=n.get(i);let a;return s===void 0?(a=new $h,n.set(i,[a])):r>=s.length?(a=new $h,s.push(a)):a=s[r],a}function t(){n=new WeakMap}return{get:e,dispose:t}}function BS(){const n={};return{get:function(e){if(n[e.id]!==void 0)return n[e.id];let t;switch(e.type){case"SunLight":case"DirectionalLight":t={direction:new N,color:new Je};break;case"SpotLight":t={position:new N,direction:new N,color:new Je,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":t={position:new N,color:new Je,distance:0,decay:0};break;case"HemisphereLight":t={direction:new N,skyColor:new Je,groundColor:new Je};break;case"RectAreaLight":t={color:new Je,position:new N,halfWidth:new N,halfHeight:new N};break}return n[e.id]=t,t}}}function kS(){const n={};return{get:function(e){if(n[e.id]!==void 0)return n[e.id];let t;switch(e.type){case"SunLight":case"DirectionalLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new We};break;case"SpotLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new We};break;case"PointLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new We,shadowCameraNear:1,shadowCameraFar:1e3};break}return n[e.id]=t,t}}}let zS=0;function HS(n,e){return(e.castShadow?2:0)-(n.castShadow?2:0)+(e.map?1:0)-(n.map?1:0)}function GS(n){const e=new BS,t=kS(),i={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let c=0;c<9;c++)i.probe.push(new N);const r=new N,s=new tt,a=new tt;function o(c){let f=0,d=0,u=0;for(let D=0;D<9;D++)i.probe[D].set(0,0,0);let h=0,g=0,x=0,m=0,p=0,v=0,y=0,S=0,E=0,A=0,_=0,b=0,I=0,R=0;c.sort(HS);for(let D=0,O=c.length;D<O;D++){const L=c[D],k=L.color,V=L.intensity,W=L.distance;let te=null;if(L.shadow&&L.shadow.map&&(L.shadow.map.texture.format===hr?te=L.shadow.map.texture:te=L.shadow.map.depthTexture||L.shadow.map.texture),L.isAmbientLight)f+=k.r*V,d+=k.g*V,u+=k.b*V;else if(L.isLightProbe){for(let X=0;X<9;X++)i.probe[X].addScaledVector(L.sh.coefficients[X],V);R++}else if(L.isSunLight){const X=e.get(L);if(X.color.copy(L.color).multiplyScalar(L.intensity),L.castShadow){const j=L.shadow,ee=t.get(L);ee.shadowIntensity=j.intensity,ee.shadowBias=j.bias,ee.shadowNormalBias=j.normalBias,ee.shadowRadius=j.radius,ee.shadowMapSize.copy(j.mapSize).multiply(j.getFrameExtents()),i.sunShadow[g]=ee,i.sunShadowMap[g]=te;const Se=j.getViewportCount();for(let De=0;De<Se;De++)i.sunShadowMatrix[x+De]=j.getMatrix(De),i.sunShadowCascade[x+De]=j._cascadeData[De];x+=Se,g++}i.sun[h]=X,h++}else if(L.isDirectionalLight){const X=e.get(L);if(X.color.copy(L.color).multiplyScalar(L.intensity),L.castShadow){const j=L.shadow,ee=t.get(L);ee.shadowIntensity=j.intensity,ee.shadowBias=j.bias,ee.shadowNormalBias=j.normalBias,ee.shadowRadius=j.radius,ee.shadowMapSize=j.mapSize,i.directionalShadow[m]=ee,i.directionalShadowMap[m]=te,i.directionalShadowMatrix[m]=L.shadow.matrix,E++}i.directional[m]=X,m++}else if(L.isSpotLight){const X=e.get(L);X.position.setFromMatrixPosition(L.matrixWorld),X.color.copy(k).multiplyScalar(V),X.distance=W,X.coneCos=Math.cos(L.angle),X.penumbraCos=Math.cos(L.angle*(1-L.penumbra)),X.decay=L.decay,i.spot[v]=X;const j=L.shadow;if(L.map&&(i.spotLightMap[b]=L.map,b++,j.updateMatrices(L),L.castShadow&&I++),i.spotLightMatrix[v]=j.matrix,L.castShadow){const ee=t.get(L);ee.shadowIntensity=j.intensity,ee.shadowBias=j.bias,ee.shadowNormalBias=j.normalBias,ee.shadowRadius=j.radius,ee.shadowMapSize=j.mapSize,i.spotShadow[v]=ee,i.spotShadowMap[v]=te,_++}v++}else if(L.isRectAreaLight){const X=e.get(L);X.color.copy(k).multiplyScalar(V),X.halfWidth.set(L.width*.5,0,0),X.halfHeight.set(0,L.height*.5,0),i.rectArea[y]=X,y++}else if(L.isPointLight){const X=e.get(L);if(X.color.copy(L.color).multiplyScalar(L.intensity),X.distance=L.distance,X.decay=L.decay,L.castShadow){const j=L.shadow,ee=t.get(L);ee.shadowIntensity=j.intensity,ee.shadowBias=j.bias,ee.shadowNormalBias=j.normalBias,ee.shadowRadius=j.radius,ee.shadowMapSize=j.mapSize,ee.shadowCameraNear=j.camera.near,ee.shadowCameraFar=j.camera.far,i.pointShadow[p]=ee,i.pointShadowMap[p]=te,i.pointShadowMatrix[p]=L.shadow.matrix,A++}i.point[p]=X,p++}else if(L.isHemisphereLight){const X=e.get(L);X.skyColor.copy(L.color).multiplyScalar(V),X.groundColor.copy(L.groundColor).multiplyScalar(V),i.hemi[S]=X,S++}}y>0&&(n.has("OES_texture_float_linear")===!0?(i.rectAreaLTC1=me.LTC_FLOAT_1,i.rectAreaLTC2=me.LTC_FLOAT_2):(i.rectAreaLTC1=me.LTC_HALF_1,i.rectAreaLTC2=me.LTC_HALF_2)),i.ambient[0]=f,i.ambient[1]=d,i.ambient[2]=u;const P=i.hash;(P.sunLength!==h||P.directionalLength!==m||P.pointLength!==p||P.spotLength!==v||P.rectAreaLength!==y||P.hemiLength!==S||P.numSunShadows!==g||P.numDirectionalShadows!==E||P.numPointShadows!==A||P.numSpotShadows!==_||P.numSpotMaps!==b||P.numLightProbes!==R)&&(i.sun.length=h,i.directional.length=m,i.spot.length=v,i.rectArea.length=y,i.point.length=p,i.hemi.length=S,i.sunShadow.length=g,i.sunShadowMap.length=g,i.sunShadowMatrix.length=x,i.sunShadowCascade.length=x,i.directionalShadow.length=E,i.directionalShadowMap.length=E,i.directionalShadowMatrix.length=E,i.pointShadow.length=A,i.pointShadowMap.length=A,i.pointShadowMatrix.length=A,i.spotShadow.length=_,i.spotShadowMap.length=_,i.spotLightMatrix.length=_+b-I,i.spotLightMap.length=b,i.numSpotLightShadowsWithMaps=I,i.numLightProbes=R,P.sunLength=h,P.directionalLength=m,P.pointLength=p,P.spotLength=v,P.rectAreaLength=y,P.hemiLength=S,P.numSunShadows=g,P.numDirectionalShadows=E,P.numPointShadows=A,P.numSpotShadows=_,P.numSpotMaps=b,P.numLightProbes=R,i.version=zS++)}function l(c,f){let d=0,u=0,h=0,g=0,x=0,m=0;const p=f.matrixWorldInverse;for(let v=0,y=c.length;v<y;v++){const S=c[v];if(S.isSunLight){const E=i.sun[d];E.direction.setFromMatrixPosition(S.matrixWorld),E.direction.transformDirection(p),d++}else if(S.isDirectionalLight){const E=i.directional[u];E.direction.setFromMatrixPosition(S.matrixWorld),r.setFromMatrixPosition(S.target.matrixWorld),E.direction.sub(r),E.direction.transformDirection(p),u++}else if(S.isSpotLight){const E=i.spot[g];E.position.setFromMatrixPosition(S.matrixWorld),E.position.applyMatrix4(p),E.direction.setFromMatrixPosition(S.matrixWorld),r.setFromMatrixPosition(S.target.matrixWorld),E.direction.sub(r),E.direction.transformDirection(p),g++}else if(S.isRectAreaLight){const E=i.rectArea[x];E.position.setFromMatrixPosition(S.matrixWorld),E.position.applyMatrix4(p),a.identity(),s.copy(S.matrixWorld),s.premultiply(p),a.extractRotation(s),E.halfWidth.set(S.width*.5,0,0),E.halfHeight.set(0,S.height*.5,0),E.halfWidth.applyMatrix4(a),E.halfHeight.applyMatrix4(a),x++}else if(S.isPointLight){const E=i.point[h];E.position.setFromMatrixPosition(S.matrixWorld),E.position.applyMatrix4(p),h++}else if(S.isHemisphereLight){const E=i.hemi[m];E.direction.setFromMatrixPosition(S.matrixWorld),E.direction.transformDirection(p),m++}}}return{setup:o,setupView:l,state:i}}function Xh(n){const e=new GS(n),t=[],i=[],r=[];function s(d){f.camera=d,t.length=0,i.length=0,r.length=0}function a(d){d.isLightProbeGrid?r.push(d):t.push(d)}function o(d){i.push(d)}function l(){e.setup(t),r.sort((d,u)=>d.priority-u.priority||d.id-u.id)}function c(d){e.setupView(t,d)}const f={lightsArray:t,shadowsArray:i,lightProbeGridArray:r,camera:null,lights:e,transmissionRenderTarget:{},textureUnits:0};return{init:s,state:f,setupLights:l,setupLightsView:c,pushLight:a,pushShadow:o}}function VS(n){let e=new WeakMap;function t(r,s=0){const a=e.get(r);let o;return a===void 0?(o=new Xh(n),e.set(r,[o])):s>=a.length?(o=new Xh(n),a.push(o)):o=a[s],o}function i(){e=new WeakMap}return{get:t,dispose:i}}const WS=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,$S=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ).rg;
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ).r;
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( max( 0.0, squared_mean - mean * mean ) );
	gl_FragColor = vec4( mean, std_dev, 0.0, 1.0 );
}`,XS=[new N(1,0,0),new N(-1,0,0),new N(0,1,0),new N(0,-1,0),new N(0,0,1),new N(0,0,-1)],qS=[new N(0,-1,0),new N(0,-1,0),new N(0,0,1),new N(0,0,-1),new N(0,-1,0),new N(0,-1,0)],qh=new tt,js=new N,fu=new N;function YS(n,e,t){let i=new ho;const r=new We,s=new We,a=new ot,o=new G_,l=new V_,c={},f=t.maxTextureSize,d={[hi]:en,[en]:hi,[un]:un},u=new Wi({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new We},radius:{value:4}},vertexShader:WS,fragmentShader:$S}),h=u.clone();h.defines.HORIZONTAL_PASS=1;const g=new Xn;g.setAttribute("position",new Ht(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));const x=new yi(g,u),m=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=Ia;let p=this.type;this.render=function(A,_,b){if(m.enabled===!1||m.autoUpdate===!1&&m.needsUpdate===!1||A.length===0)return;this.type===Ag&&(Le("WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead."),this.type=Ia);const I=n.getRenderTarget(),R=n.getActiveCubeFace(),P=n.getActiveMipmapLevel(),D=n.state;D.setBlending(Hr),D.buffers.depth.getReversed()===!0?D.buffers.color.setClear(0,0,0,0):D.buffers.color.setClear(1,1,1,1),D.buffers.depth.setTest(!0),D.setScissorTest(!1);const O=p!==this.type;O&&_.traverse(function(L){L.material&&(Array.isArray(L.material)?L.material.forEach(k=>k.needsUpdate=!0):L.material.needsUpdate=!0)});for(let L=0,k=A.length;L<k;L++){const V=A[L],W=V.shadow;if(W===void 0){Le("WebGLShadowMap:",V,"has no shadow.");continue}if(W.autoUpdate===!1&&W.needsUpdate===!1)continue;r.copy(W.mapSize);const te=W.getFrameExtents();r.multiply(te),s.copy(W.mapSize),(r.x>f||r.y>f)&&(r.x>f&&(s.x=Math.floor(f/te.x),r.x=s.x*te.x,W.mapSize.x=s.x),r.y>f&&(s.y=Math.floor(f/te.y),r.y=s.y*te.y,W.mapSize.y=s.y));const X=n.state.buffers.depth.getReversed();if(W.camera._reversedDepth=X,W.map===null||O===!0){if(W.map!==null&&(W.map.depthTexture!==null&&(W.map.depthTexture.dispose(),W.map.depthTexture=null),W.map.dispose()),this.type===Bs){if(V.isPointLight){Le("WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.");continue}W.map=new Dn(r.x,r.y,{format:hr,type:Wn,minFilter:on,magFilter:on,generateMipmaps:!1}),W.map.texture.name=V.name+".shadowMap",W.map.depthTexture=new ns(r.x,r.y,Vn),W.map.depthTexture.name=V.name+".shadowMapDepth",W.map.depthTexture.format=Fi,W.map.depthTexture.compareFunction=null,W.map.depthTexture.minFilter=kt,W.map.depthTexture.magFilter=kt}else V.isPointLight?(W.map=new lu(r.x),W.map.depthTexture=new lh(r.x,Gn)):(W.map=new Dn(r.x,r.y),W.map.depthTexture=new ns(r.x,r.y,Gn)),W.map.depthTexture.name=V.name+".shadowMap",W.map.depthTexture.format=Fi,this.type===Ia?(W.map.depthTexture.compareFunction=X?Pd:Cd,W.map.depthTexture.minFilter=on,W.map.depthTexture.magFilter=on):(W.map.depthTexture.compareFunction=null,W.map.depthTexture.minFilter=kt,W.map.depthTexture.magFilter=kt);W.camera.updateProjectionMatrix()}W.map.isWebGLCubeRenderTarget!==!0&&(W.map.width!==r.x||W.map.height!==r.y)&&W.map.setSize(r.x,r.y);const j=W.map.isWebGLCubeRenderTarget?6:W.getViewportCount();V.isPointLight!==!0&&W.updateMatrices(V,b);const ee=(W.camera.layers.mask&4294967294)!==0?W.camera.layers:b.layers;for(let Se=0;Se<j;Se++){const De=W.getCamera(Se);if(V.isPointLight){const Z=W.camera,fe=W.matrix,xe=V.distance||Z.far;xe!==Z.far&&(Z.far=xe,Z.updateProjectionMatrix()),js.setFromMatrixPosition(V.matrixWorld),Z.position.copy(js),fu.copy(Z.position),fu.add(XS[Se]),Z.up.copy(qS[Se]),Z.lookAt(fu),Z.updateMatrixWorld(),fe.makeTranslation(-js.x,-js.y,-js.z),qh.multiplyMatrices(Z.projectionMatrix,Z.matrixWorldInverse),W._frustum.setFromProjectionMatrix(qh,Z.coordinateSystem,Z.reversedDepth)}if(W.map.isWebGLCubeRenderTarget)n.setRenderTarget(W.map,Se),n.clear();else{Se===0&&(n.setRenderTarget(W.map),n.clear());const Z=W.getViewport(Se);a.set(s.x*Z.x,s.y*Z.y,s.x*Z.z,s.y*Z.w),D.viewport(a)}i=W.getFrustum(Se),S(_,b,De,V,ee,this.type)}W.isPointLightShadow!==!0&&this.type===Bs&&v(W,b),W.needsUpdate=!1}p=this.type,m.needsUpdate=!1,n.setRenderTarget(I,R,P)};function v(A,_){const b=e.update(x);u.defines.VSM_SAMPLES!==A.blurSamples&&(u.defines.VSM_SAMPLES=A.blurSamples,h.defines.VSM_SAMPLES=A.blurSamples,u.needsUpdate=!0,h.needsUpdate=!0),A.mapPass===null?A.mapPass=new Dn(r.x,r.y,{format:hr,type:Wn}):(A.mapPass.width!==A.map.width||A.mapPass.height!==A.map.height)&&A.mapPass.setSize(A.map.width,A.map.height),u.uniforms.shadow_pass.value=A.map.depthTexture,u.uniforms.resolution.value.set(A.map.width,A.map.height),u.uniforms.radius.value=A.radius,n.setRenderTarget(A.mapPass),n.clear(),n.renderBufferDirect(_,null,b,u,x,null),h.uniforms.shadow_pass.value=A.mapPass.texture,h.uniforms.resolution.value.set(A.map.width,A.map.height),h.uniforms.radius.value=A.radius,n.setRenderTarget(A.map),n.clear(),n.renderBufferDirect(_,null,b,h,x,null)}function y(A,_,b,I){let R=null;const P=b.isPointLight===!0?A.customDistanceMaterial:A.customDepthMaterial;if(P!==void 0)R=P;else if(R=b.isPointLight===!0?l:o,n.localClippingEnabled&&_.clipShadows===!0&&Array.isArray(_.clippingPlanes)&&_.clippingPlanes.length!==0||_.displacementMap&&_.displacementScale!==0||_.alphaMap&&_.alphaTest>0||_.map&&_.alphaTest>0||_.alphaToCoverage===!0){const D=R.uuid,O=_.uuid;let L=c[D];L===void 0&&(L={},c[D]=L);let k=L[O];k===void 0&&(k=R.clone(),L[O]=k,_.addEventListener("dispose",E)),R=k}if(R.visible=_.visible,R.wireframe=_.wireframe,I===Bs?R.side=_.shadowSide!==null?_.shadowSide:_.side:R.side=_.shadowSide!==null?_.shadowSide:d[_.side],R.alphaMap=_.alphaMap,R.alphaTest=_.alphaToCoverage===!0?.5:_.alphaTest,R.map=_.map,R.clipShadows=_.clipShadows,R.clippingPlanes=_.clippingPlanes,R.clipIntersection=_.clipIntersection,R.displacementMap=_.displacementMap,R.displacementScale=_.displacementScale,R.displacementBias=_.displacementBias,R.wireframeLinewidth=_.wireframeLinewidth,R.linewidth=_.linewidth,b.isPointLight===!0&&R.isMeshDistanceMaterial===!0){const D=n.properties.get(R);D.light=b}return R}function S(A,_,b,I,R,P){if(A.visible===!1)return;if(A.layers.test(R)&&(A.isMesh||A.isLine||A.isPoints)&&(A.castShadow||A.receiveShadow&&P===Bs)&&(!A.frustumCulled||A.intersectsFrustum(i))){A.modelViewMatrix.multiplyMatrices(b.matrixWorldInverse,A.matrixWorld);const L=e.update(A),k=A.material;if(Array.isArray(k)){const V=L.groups;for(let W=0,te=V.length;W<te;W++){const X=V[W],j=k[X.materialIndex];if(j&&j.visible){const ee=y(A,j,I,P);A.onBeforeShadow(n,A,_,b,L,ee,X),n.renderBufferDirect(b,null,L,ee,A,X),A.onAfterShadow(n,A,_,b,L,ee,X)}}}else if(k.visible){const V=y(A,k,I,P);A.onBeforeShadow(n,A,_,b,L,V,null),n.renderBufferDirect(b,null,L,V,A,null),A.onAfterShadow(n,A,_,b,L,V,null)}}const O=A.children;for(let L=0,k=O.length;L<k;L++)S(O[L],_,b,I,R,P)}function E(A){A.target.removeEventListener("dispose",E);for(const b in c){const I=c[b],R=A.target.uuid;R in I&&(I[R].dispose(),delete I[R])}}}function KS(n,e){function t(){let U=!1;const J=new ot;let q=null;const ce=new ot(0,0,0,0);return{setMask:function(se){q!==se&&!U&&(n.colorMask(se,se,se,se),q=se)},setLocked:function(se){U=se},setClear:function(se,oe,we,Ge,ie){ie===!0&&(se*=Ge,oe*=Ge,we*=Ge),J.set(se,oe,we,Ge),ce.equals(J)===!1&&(n.clearColor(se,oe,we,Ge),ce.copy(J))},reset:function(){U=!1,q=null,ce.set(-1,0,0,0)}}}function i(){let U=!1,J=!1,q=null,ce=null,se=null;return{setReversed:function(oe){if(J!==oe){const we=e.get("EXT_clip_control");oe?we.clipControlEXT(we.LOWER_LEFT_EXT,we.ZERO_TO_ONE_EXT):we.clipControlEXT(we.LOWER_LEFT_EXT,we.NEGATIVE_ONE_TO_ONE_EXT),J=oe;const Ge=se;se=null,this.setClear(Ge)}},getReversed:function(){return J},setTest:function(oe){oe?ge(n.DEPTH_TEST):Ie(n.DEPTH_TEST)},setMask:function(oe){q!==oe&&!U&&(n.depthMask(oe),q=oe)},setFunc:function(oe){if(J&&(oe=o_[oe]),ce!==oe){switch(oe){case Ol:n.depthFunc(n.NEVER);break;case Bl:n.depthFunc(n.ALWAYS);break;case kl:n.depthFunc(n.LESS);break;case zs:n.depthFunc(n.LEQUAL);break;case zl:n.depthFunc(n.EQUAL);break;case Hl:n.depthFunc(n.GEQUAL);break;case Gl:n.depthFunc(n.GREATER);break;case Vl:n.depthFunc(n.NOTEQUAL);break;default:n.depthFunc(n.LEQUAL)}ce=oe}},setLocked:function(oe){U=oe},setClear:function(oe){se!==oe&&(se=oe,J&&(oe=1-oe),n.clearDepth(oe))},reset:function(){U=!1,q=null,ce=null,se=null,J=!1}}}function r(){let U=!1,J=null,q=null,ce=null,se=null,oe=null,we=null,Ge=null,ie=null;return{setTest:function(Te){U||(Te?ge(n.STENCIL_TEST):Ie(n.STENCIL_TEST))},setMask:function(Te){J!==Te&&!U&&(n.stencilMask(Te),J=Te)},setFunc:function(Te,ke,_e){(q!==Te||ce!==ke||se!==_e)&&(n.stencilFunc(Te,ke,_e),q=Te,ce=ke,se=_e)},setOp:function(Te,ke,_e){(oe!==Te||we!==ke||Ge!==_e)&&(n.stencilOp(Te,ke,_e),oe=Te,we=ke,Ge=_e)},setLocked:function(Te){U=Te},setClear:function(Te){ie!==Te&&(n.clearStencil(Te),ie=Te)},reset:function(){U=!1,J=null,q=null,ce=null,se=null,oe=null,we=null,Ge=null,ie=null}}}const s=new t,a=new i,o=new r;let l={};const c=new WeakMap;let f={},d={},u={},h=new WeakMap,g=[],x=null,m=!1,p=null,v=null,y=null,S=null,E=null,A=null,_=null,b=new Je(0,0,0),I=0,R=!1,P=null,D=null,O=null,L=null,k=null;const V=n.getParameter(n.MAX_COMBINED_TEXTURE_IMAGE_UNITS);let W=!1,te=0;const X=n.getParameter(n.VERSION);X.indexOf("WebGL")!==-1?(te=parseFloat(/^WebGL (\d)/.exec(X)[1]),W=te>=1):X.indexOf("OpenGL ES")!==-1&&(te=parseFloat(/^OpenGL ES (\d)/.exec(X)[1]),W=te>=2);let j=null,ee={};const Se=n.getParameter(n.SCISSOR_BOX),De=n.getParameter(n.VIEWPORT),Z=new ot().fromArray(Se),fe=new ot().fromArray(De);function xe(U,J,q,ce){const se=new Uint8Array(4),oe=n.createTexture();n.bindTexture(U,oe),n.texParameteri(U,n.TEXTURE_MIN_FILTER,n.NEAREST),n.texParameteri(U,n.TEXTURE_MAG_FILTER,n.NEAREST);for(let we=0;we<q;we++)U===n.TEXTURE_3D||U===n.TEXTURE_2D_ARRAY?n.texImage3D(J,0,n.RGBA,1,1,ce,0,n.RGBA,n.UNSIGNED_BYTE,se):n.texImage2D(J+we,0,n.RGBA,1,1,0,n.RGBA,n.UNSIGNED_BYTE,se);return oe}const Ae={};Ae[n.TEXTURE_2D]=xe(n.TEXTURE_2D,n.TEXTURE_2D,1),Ae[n.TEXTURE_CUBE_MAP]=xe(n.TEXTURE_CUBE_MAP,n.TEXTURE_CUBE_MAP_POSITIVE_X,6),Ae[n.TEXTURE_2D_ARRAY]=xe(n.TEXTURE_2D_ARRAY,n.TEXTURE_2D_ARRAY,1,1),Ae[n.TEXTURE_3D]=xe(n.TEXTURE_3D,n.TEXTURE_3D,1,1),s.setClear(0,0,0,1),a.setClear(1),o.setClear(0),ge(n.DEPTH_TEST),a.setFunc(zs),cn(!1),pt(ad),ge(n.CULL_FACE),Gt(Hr);function ge(U){f[U]!==!0&&(n.enable(U),f[U]=!0)}function Ie(U){f[U]!==!1&&(n.disable(U),f[U]=!1)}function _t(U,J){return u[U]!==J?(n.bindFramebuffer(U,J),u[U]=J,U===n.DRAW_FRAMEBUFFER&&(u[n.FRAMEBUFFER]=J),U===n.FRAMEBUFFER&&(u[n.DRAW_FRAMEBUFFER]=J),!0):!1}function Re(U,J){let q=g,ce=!1;if(U){q=h.get(J),q===void 0&&(q=[],h.set(J,q));const se=U.textures;if(q.length!==se.length||q[0]!==n.COLOR_ATTACHMENT0){for(let oe=0,we=se.length;oe<we;oe++)q[oe]=n.COLOR_ATTACHMENT0+oe;q.length=se.length,ce=!0}}else q[0]!==n.BACK&&(q[0]=n.BACK,ce=!0);ce&&n.drawBuffers(q)}function Ke(U){return x!==U?(n.useProgram(U),x=U,!0):!1}const st={[Gr]:n.FUNC_ADD,[Cg]:n.FUNC_SUBTRACT,[Pg]:n.FUNC_REVERSE_SUBTRACT};st[Lg]=n.MIN,st[Dg]=n.MAX;const $e={[Ig]:n.ZERO,[Ng]:n.ONE,[Ug]:n.SRC_COLOR,[ud]:n.SRC_ALPHA,[Hg]:n.SRC_ALPHA_SATURATE,[kg]:n.DST_COLOR,[Og]:n.DST_ALPHA,[Fg]:n.ONE_MINUS_SRC_COLOR,[fd]:n.ONE_MINUS_SRC_ALPHA,[zg]:n.ONE_MINUS_DST_COLOR,[Bg]:n.ONE_MINUS_DST_ALPHA,[Gg]:n.CONSTANT_COLOR,[Vg]:n.ONE_MINUS_CONSTANT_COLOR,[Wg]:n.CONSTANT_ALPHA,[$g]:n.ONE_MINUS_CONSTANT_ALPHA};function Gt(U,J,q,ce,se,oe,we,Ge,ie,Te){if(U===Hr){m===!0&&(Ie(n.BLEND),m=!1);return}if(m===!1&&(ge(n.BLEND),m=!0),U!==Rg){if(U!==p||Te!==R){if((v!==Gr||E!==Gr)&&(n.blendEquation(n.FUNC_ADD),v=Gr,E=Gr),Te)switch(U){case ks:n.blendFuncSeparate(n.ONE,n.ONE_MINUS_SRC_ALPHA,n.ONE,n.ONE_MINUS_SRC_ALPHA);break;case od:n.blendFunc(n.ONE,n.ONE);break;case ld:n.blendFuncSeparate(n.ZERO,n.ONE_MINUS_SRC_COLOR,n.ZERO,n.ONE);break;case cd:n.blendFuncSeparate(n.DST_COLOR,n.ONE_MINUS_SRC_ALPHA,n.ZERO,n.ONE);break;default:Qe("WebGLState: Invalid blending: ",U);break}else switch(U){case ks:n.blendFuncSeparate(n.SRC_ALPHA,n.ONE_MINUS_SRC_ALPHA,n.ONE,n.ONE_MINUS_SRC_ALPHA);break;case od:n.blendFuncSeparate(n.SRC_ALPHA,n.ONE,n.ONE,n.ONE);break;case ld:Qe("WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true");break;case cd:Qe("WebGLState: MultiplyBlending requires material.premultipliedAlpha = true");break;default:Qe("WebGLState: Invalid blending: ",U);break}y=null,S=null,A=null,_=null,b.set(0,0,0),I=0,p=U,R=Te}return}se=se||J,oe=oe||q,we=we||ce,(J!==v||se!==E)&&(n.blendEquationSeparate(st[J],st[se]),v=J,E=se),(q!==y||ce!==S||oe!==A||we!==_)&&(n.blendFuncSeparate($e[q],$e[ce],$e[oe],$e[we]),y=q,S=ce,A=oe,_=we),(Ge.equals(b)===!1||ie!==I)&&(n.blendColor(Ge.r,Ge.g,Ge.b,ie),b.copy(Ge),I=ie),p=U,R=!1}function Lt(U,J){U.side===un?Ie(n.CULL_FACE):ge(n.CULL_FACE);let q=U.side===en;J&&(q=!q),cn(q),U.blending===ks&&U.transparent===!1?Gt(Hr):Gt(U.blending,U.blendEquation,U.blendSrc,U.blendDst,U.blendEquationAlpha,U.blendSrcAlpha,U.blendDstAlpha,U.blendColor,U.blendAlpha,U.premultipliedAlpha),a.setFunc(U.depthFunc),a.setTest(U.depthTest),a.setMask(U.depthWrite),s.setMask(U.colorWrite);const ce=U.stencilWrite;o.setTest(ce),ce&&(o.setMask(U.stencilWriteMask),o.setFunc(U.stencilFunc,U.stencilRef,U.stencilFuncMask),o.setOp(U.stencilFail,U.stencilZFail,U.stencilZPass)),Ut(U.polygonOffset,U.polygonOffsetFactor,U.polygonOffsetUnits),U.alphaToCoverage===!0?ge(n.SAMPLE_ALPHA_TO_COVERAGE):Ie(n.SAMPLE_ALPHA_TO_COVERAGE)}function cn(U){P!==U&&(U?n.frontFace(n.CW):n.frontFace(n.CCW),P=U)}function pt(U){U!==wg?(ge(n.CULL_FACE),U!==D&&(U===ad?n.cullFace(n.BACK):U===Tg?n.cullFace(n.FRONT):n.cullFace(n.FRONT_AND_BACK))):Ie(n.CULL_FACE),D=U}function ai(U){U!==O&&(W&&n.lineWidth(U),O=U)}function Ut(U,J,q){U?(ge(n.POLYGON_OFFSET_FILL),(L!==J||k!==q)&&(L=J,k=q,a.getReversed()&&(J=-J,q=-q),n.polygonOffset(J,q))):Ie(n.POLYGON_OFFSET_FILL)}function An(U){U?ge(n.SCISSOR_TEST):Ie(n.SCISSOR_TEST)}function Rn(U){U===void 0&&(U=n.TEXTURE0+V-1),j!==U&&(n.activeTexture(U),j=U)}function Cn(U,J,q){q===void 0&&(j===null?q=n.TEXTURE0+V-1:q=j);let ce=ee[q];ce===void 0&&(ce={type:void 0,texture:void 0},ee[q]=ce),(ce.type!==U||ce.texture!==J)&&(j!==q&&(n.activeTexture(q),j=q),n.bindTexture(U,J||Ae[U]),ce.type=U,ce.texture=J)}function B(){const U=ee[j];U!==void 0&&U.type!==void 0&&(n.bindTexture(U.type,null),U.type=void 0,U.texture=void 0)}function Pn(){try{n.compressedTexImage2D(...arguments)}catch(U){Qe("WebGLState:",U)}}function ft(){try{n.compressedTexImage3D(...arguments)}catch(U){Qe("WebGLState:",U)}}function dt(){try{n.texSubImage2D(...arguments)}catch(U){Qe("WebGLState:",U)}}function pe(){try{n.texSubImage3D(...arguments)}catch(U){Qe("WebGLState:",U)}}function Dt(){try{n.compressedTexSubImage2D(...arguments)}catch(U){Qe("WebGLState:",U)}}function Ce(){try{n.compressedTexSubImage3D(...arguments)}catch(U){Qe("WebGLState:",U)}}function Ne(){try{n.texStorage2D(...arguments)}catch(U){Qe("WebGLState:",U)}}function C(){try{n.texStorage3D(...arguments)}catch(U){Qe("WebGLState:",U)}}function w(){try{n.texImage2D(...arguments)}catch(U){Qe("WebGLState:",U)}}function H(){try{n.texImage3D(...arguments)}catch(U){Qe("WebGLState:",U)}}function ne(U){return d[U]!==void 0?d[U]:n.getParameter(U)}function Q(U,J){d[U]!==J&&(n.pixelStorei(U,J),d[U]=J)}function ae(U){Z.equals(U)===!1&&(n.scissor(U.x,U.y,U.z,U.w),Z.copy(U))}function de(U){fe.equals(U)===!1&&(n.viewport(U.x,U.y,U.z,U.w),fe.copy(U))}function Y(U,J){let q=c.get(J);q===void 0&&(q=new WeakMap,c.set(J,q));let ce=q.get(U);ce===void 0&&(ce=n.getUniformBlockIndex(J,U.name),n.uniformBlockBinding(J,ce,ce),q.set(U,ce))}function K(U,J,q){const se=c.get(J).get(U);l[se]!==q&&(n.bindBufferBase(n.UNIFORM_BUFFER,se,q),l[se]=q)}function le(){n.disable(n.BLEND),n.disable(n.CULL_FACE),n.disable(n.DEPTH_TEST),n.disable(n.POLYGON_OFFSET_FILL),n.disable(n.SCISSOR_TEST),n.disable(n.STENCIL_TEST),n.disable(n.SAMPLE_ALPHA_TO_COVERAGE),n.blendEquation(n.FUNC_ADD),n.blendFunc(n.ONE,n.ZERO),n.blendFuncSeparate(n.ONE,n.ZERO,n.ONE,n.ZERO),n.blendColor(0,0,0,0),n.colorMask(!0,!0,!0,!0),n.clearColor(0,0,0,0),n.depthMask(!0),n.depthFunc(n.LESS),a.setReversed(!1),n.clearDepth(1),n.stencilMask(4294967295),n.stencilFunc(n.ALWAYS,0,4294967295),n.stencilOp(n.KEEP,n.KEEP,n.KEEP),n.clearStencil(0),n.cullFace(n.BACK),n.frontFace(n.CCW),n.polygonOffset(0,0),n.activeTexture(n.TEXTURE0),n.bindFramebuffer(n.FRAMEBUFFER,null),n.bindFramebuffer(n.DRAW_FRAMEBUFFER,null),n.bindFramebuffer(n.READ_FRAMEBUFFER,null),n.useProgram(null),n.lineWidth(1),n.scissor(0,0,n.canvas.width,n.canvas.height),n.viewport(0,0,n.canvas.width,n.canvas.height),n.pixelStorei(n.PACK_ALIGNMENT,4),n.pixelStorei(n.UNPACK_ALIGNMENT,4),n.pixelStorei(n.UNPACK_FLIP_Y_WEBGL,!1),n.pixelStorei(n.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),n.pixelStorei(n.UNPACK_COLORSPACE_CONVERSION_WEBGL,n.BROWSER_DEFAULT_WEBGL),n.pixelStorei(n.PACK_ROW_LENGTH,0),n.pixelStorei(n.PACK_SKIP_PIXELS,0),n.pixelStorei(n.PACK_SKIP_ROWS,0),n.pixelStorei(n.UNPACK_ROW_LENGTH,0),n.pixelStorei(n.UNPACK_IMAGE_HEIGHT,0),n.pixelStorei(n.UNPACK_SKIP_PIXELS,0),n.pixelStorei(n.UNPACK_SKIP_ROWS,0),n.pixelStorei(n.UNPACK_SKIP_IMAGES,0),f={},d={},j=null,ee={},u={},l={},h=new WeakMap,g=[],x=null,m=!1,p=null,v=null,y=null,S=null,E=null,A=null,_=null,b=new Je(0,0,0),I=0,R=!1,P=null,D=null,O=null,L=null,k=null,Z.set(0,0,n.canvas.width,n.canvas.height),fe.set(0,0,n.canvas.width,n.canvas.height),s.reset(),a.reset(),o.reset()}return{buffers:{color:s,depth:a,stencil:o},enable:ge,disable:Ie,bindFramebuffer:_t,drawBuffers:Re,useProgram:Ke,setBlending:Gt,setMaterial:Lt,setFlipSided:cn,setCullFace:pt,setLineWidth:ai,setPolygonOffset:Ut,setScissorTest:An,activeTexture:Rn,bindTexture:Cn,unbindTexture:B,compressedTexImage2D:Pn,compressedTexImage3D:ft,texImage2D:w,texImage3D:H,pixelStorei:Q,getParameter:ne,updateUBOMapping:Y,uniformBlockBinding:K,texStorage2D:Ne,texStorage3D:C,texSubImage2D:dt,texSubImage3D:pe,compressedTexSubImage2D:Dt,compressedTexSubImage3D:Ce,scissor:ae,viewport:de,reset:le}}function ZS(n,e,t,i,r,s,a){const o=e.has("WEBGL_multisampled_render_to_texture")?e.get("WEBGL_multisampled_render_to_texture"):null,l=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),c=new We,f=new WeakMap,d=new Set;let u;const h=new WeakMap,g=new Set,x=new FinalizationRegistry(C=>g.delete(C));let m=!1;try{m=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function p(C,w){return m?new OffscreenCanvas(C,w):Wa("canvas")}function v(C,w,H){let ne=1;const Q=Ne(C);if((Q.width>H||Q.height>H)&&(ne=H/Math.max(Q.width,Q.height)),ne<1)if(typeof HTMLImageElement<"u"&&C instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&C instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&C instanceof ImageBitmap||typeof VideoFrame<"u"&&C instanceof VideoFrame){const ae=Math.floor(ne*Q.width),de=Math.floor(ne*Q.height);u===void 0&&(u=p(ae,de));const Y=w?p(ae,de):u;return Y.width=ae,Y.height=de,Y.getContext("2d").drawImage(C,0,0,ae,de),Le("WebGLRenderer: Texture has been resized from ("+Q.width+"x"+Q.height+") to ("+ae+"x"+de+")."),Y}else return"data"in C&&Le("WebGLRenderer: Image in DataTexture is too big ("+Q.width+"x"+Q.height+")."),C;return C}function y(C){return C.generateMipmaps}function S(C){n.generateMipmap(C)}function E(C){return C.isWebGLCubeRenderTarget?n.TEXTURE_CUBE_MAP:C.isWebGL3DRenderTarget?n.TEXTURE_3D:C.isWebGLArrayRenderTarget||C.isCompressedArrayTexture?n.TEXTURE_2D_ARRAY:n.TEXTURE_2D}function A(C,w,H,ne,Q,ae=!1){if(C!==null){if(n[C]!==void 0)return n[C];Le("WebGLRenderer: Attempt to use non-existing WebGL internal format '"+C+"'")}let de;ne&&(de=e.get("EXT_texture_norm16"),de||Le("WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension"));let Y=w;if(w===n.RED&&(H===n.FLOAT&&(Y=n.R32F),H===n.HALF_FLOAT&&(Y=n.R16F),H===n.UNSIGNED_BYTE&&(Y=n.R8),H===n.UNSIGNED_SHORT&&de&&(Y=de.R16_EXT),H===n.SHORT&&de&&(Y=de.R16_SNORM_EXT)),w===n.RED_INTEGER&&(H===n.UNSIGNED_BYTE&&(Y=n.R8UI),H===n.UNSIGNED_SHORT&&(Y=n.R16UI),H===n.UNSIGNED_INT&&(Y=n.R32UI),H===n.BYTE&&(Y=n.R8I),H===n.SHORT&&(Y=n.R16I),H===n.INT&&(Y=n.R32I)),w===n.RG&&(H===n.FLOAT&&(Y=n.RG32F),H===n.HALF_FLOAT&&(Y=n.RG16F),H===n.UNSIGNED_BYTE&&(Y=n.RG8),H===n.UNSIGNED_SHORT&&de&&(Y=de.RG16_EXT),H===n.SHORT&&de&&(Y=de.RG16_SNORM_EXT)),w===n.RG_INTEGER&&(H===n.UNSIGNED_BYTE&&(Y=n.RG8UI),H===n.UNSIGNED_SHORT&&(Y=n.RG16UI),H===n.UNSIGNED_INT&&(Y=n.RG32UI),H===n.BYTE&&(Y=n.RG8I),H===n.SHORT&&(Y=n.RG16I),H===n.INT&&(Y=n.RG32I)),w===n.RGB_INTEGER&&(H===n.UNSIGNED_BYTE&&(Y=n.RGB8UI),H===n.UNSIGNED_SHORT&&(Y=n.RGB16UI),H===n.UNSIGNED_INT&&(Y=n.RGB32UI),H===n.BYTE&&(Y=n.RGB8I),H===n.SHORT&&(Y=n.RGB16I),H===n.INT&&(Y=n.RGB32I)),w===n.RGBA_INTEGER&&(H===n.UNSIGNED_BYTE&&(Y=n.RGBA8UI),H===n.UNSIGNED_SHORT&&(Y=n.RGBA16UI),H===n.UNSIGNED_INT&&(Y=n.RGBA32UI),H===n.BYTE&&(Y=n.RGBA8I),H===n.SHORT&&(Y=n.RGBA16I),H===n.INT&&(Y=n.RGBA32I)),w===n.RGB&&(H===n.UNSIGNED_SHORT&&de&&(Y=de.RGB16_EXT),H===n.SHORT&&de&&(Y=de.RGB16_SNORM_EXT),H===n.UNSIGNED_INT_5_9_9_9_REV&&(Y=n.RGB9_E5),H===n.UNSIGNED_INT_10F_11F_11F_REV&&(Y=n.R11F_G11F_B10F)),w===n.RGBA){const K=ae?Ga:Ye.getTransfer(Q);H===n.FLOAT&&(Y=n.RGBA32F),H===n.HALF_FLOAT&&(Y=n.RGBA16F),H===n.UNSIGNED_BYTE&&(Y=K===nt?n.SRGB8_ALPHA8:n.RGBA8),H===n.UNSIGNED_SHORT&&de&&(Y=de.RGBA16_EXT),H===n.SHORT&&de&&(Y=de.RGBA16_SNORM_EXT),H===n.UNSIGNED_SHORT_4_4_4_4&&(Y=n.RGBA4),H===n.UNSIGNED_SHORT_5_5_5_1&&(Y=n.RGB5_A1)}return(Y===n.R16F||Y===n.R32F||Y===n.RG16F||Y===n.RG32F||Y===n.RGBA16F||Y===n.RGBA32F)&&e.get("EXT_color_buffer_float"),Y}function _(C,w){let H;return C?w===null||w===Gn||w===Wr?H=n.DEPTH24_STENCIL8:w===Vn?H=n.DEPTH32F_STENCIL8:w===Gs&&(H=n.DEPTH24_STENCIL8,Le("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):w===null||w===Gn||w===Wr?H=n.DEPTH_COMPONENT24:w===Vn?H=n.DEPTH_COMPONENT32F:w===Gs&&(H=n.DEPTH_COMPONENT16),H}function b(C,w){return y(C)===!0||C.isFramebufferTexture&&C.minFilter!==kt&&C.minFilter!==on?Math.log2(Math.max(w.width,w.height))+1:C.mipmaps.length>0?C.mipmaps.length:C.isCompressedTexture&&Array.isArray(C.image)?w.mipmaps.length:1}function I(C){const w=new WeakRef(C);i.get(C).__ref=w,g.add(w),x.register(C,w,w)}function R(C){const w=i.get(C).__ref;w!==void 0&&(g.delete(w),x.unregister(w))}function P(C){O(C.target)}function D(C){L(C.target)}function O(C){C.removeEventListener("dispose",P),R(C),V(C),C.isVideoTexture&&f.delete(C),C.isHTMLTexture&&d.delete(C)}function L(C){C.removeEventListener("dispose",D),R(C),te(C)}function k(){for(const C of g){const w=C.deref();w!==void 0&&(w.isRenderTarget===!0?L(w):O(w))}g.clear(),d.clear()}function V(C){const w=i.get(C);if(w.__webglInit===void 0)return;const H=C.source,ne=h.get(H);if(ne){const Q=ne[w.__cacheKey];Q.usedTimes--,Q.usedTimes===0&&W(C),Object.keys(ne).length===0&&h.delete(H)}i.remove(C)}function W(C){const w=i.get(C);n.deleteTexture(w.__webglTexture);const H=C.source,ne=h.get(H);delete ne[w.__cacheKey],a.memory.textures--}function te(C){const w=i.get(C);w.__depthDisposeCallback&&w.__depthDisposeCallback();const H=C.depthTexture;if(H&&H.renderTarget===C&&O(H),C.isWebGLCubeRenderTarget)for(let Q=0;Q<6;Q++){if(Array.isArray(w.__webglFramebuffer[Q]))for(let ae=0;ae<w.__webglFramebuffer[Q].length;ae++)n.deleteFramebuffer(w.__webglFramebuffer[Q][ae]);else n.deleteFramebuffer(w.__webglFramebuffer[Q]);w.__webglDepthbuffer&&n.deleteRenderbuffer(w.__webglDepthbuffer[Q])}else{if(Array.isArray(w.__webglFramebuffer))for(let Q=0;Q<w.__webglFramebuffer.length;Q++)n.deleteFramebuffer(w.__webglFramebuffer[Q]);else n.deleteFramebuffer(w.__webglFramebuffer);if(w.__webglDepthbuffer&&n.deleteRenderbuffer(w.__webglDepthbuffer),w.__webglMultisampledFramebuffer&&n.deleteFramebuffer(w.__webglMultisampledFramebuffer),w.__webglColorRenderbuffer)for(let Q=0;Q<w.__webglColorRenderbuffer.length;Q++)w.__webglColorRenderbuffer[Q]&&n.deleteRenderbuffer(w.__webglColorRenderbuffer[Q]);w.__webglDepthRenderbuffer&&n.deleteRenderbuffer(w.__webglDepthRenderbuffer)}const ne=C.textures;for(let Q=0,ae=ne.length;Q<ae;Q++){const de=i.get(ne[Q]);de.__webglTexture&&(n.deleteTexture(de.__webglTexture),a.memory.textures--),i.remove(ne[Q])}i.remove(C)}let X=0;function j(){X=0}function ee(){return X}function Se(C){X=C}function De(){const C=X;return C>=r.maxTextures&&Le("WebGLTextures: Trying to use "+(C+1)+" texture units while this GPU supports only "+r.maxTextures),X+=1,C}function Z(C){const w=[];return w.push(C.wrapS),w.push(C.wrapT),w.push(C.wrapR||0),w.push(C.magFilter),w.push(C.minFilter),w.push(C.anisotropy),w.push(C.internalFormat),w.push(C.format),w.push(C.type),w.push(C.generateMipmaps),w.push(C.mipmapsAutoUpdate),w.push(C.premultiplyAlpha),w.push(C.flipY),w.push(C.unpackAlignment),w.push(C.colorSpace),w.join()}function fe(C,w){const H=i.get(C);if(C.isVideoTexture&&Dt(C),C.isRenderTargetTexture===!1&&C.isExternalTexture!==!0&&C.version>0&&H.__version!==C.version){const ne=C.image;if(ne===null)Le("WebGLRenderer: Texture marked for update but no image data found.");else if(ne.complete===!1)Le("WebGLRenderer: Texture marked for update but image is incomplete");else{Lt(H,C,w);return}}else C.isExternalTexture&&(H.__webglTexture=C.sourceTexture?C.sourceTexture:null);t.bindTexture(n.TEXTURE_2D,H.__webglTexture,n.TEXTURE0+w)}function xe(C,w){const H=i.get(C);if(C.isRenderTargetTexture===!1&&C.version>0&&H.__version!==C.version){Lt(H,C,w);return}else C.isExternalTexture&&(H.__webglTexture=C.sourceTexture?C.sourceTexture:null);t.bindTexture(n.TEXTURE_2D_ARRAY,H.__webglTexture,n.TEXTURE0+w)}function Ae(C,w){const H=i.get(C);if(C.isRenderTargetTexture===!1&&C.version>0&&H.__version!==C.version){Lt(H,C,w);return}t.bindTexture(n.TEXTURE_3D,H.__webglTexture,n.TEXTURE0+w)}function ge(C,w){const H=i.get(C);if(C.version>0&&H.__version!==C.version){cn(H,C,w);return}t.bindTexture(n.TEXTURE_CUBE_MAP,H.__webglTexture,n.TEXTURE0+w)}const Ie={[Xl]:n.REPEAT,[mi]:n.CLAMP_TO_EDGE,[ql]:n.MIRRORED_REPEAT},_t={[kt]:n.NEAREST,[Yg]:n.NEAREST_MIPMAP_NEAREST,[Na]:n.NEAREST_MIPMAP_LINEAR,[on]:n.LINEAR,[Yl]:n.LINEAR_MIPMAP_NEAREST,[Ui]:n.LINEAR_MIPMAP_LINEAR},Re={[Qg]:n.NEVER,[Ld]:n.ALWAYS,[jg]:n.LESS,[Cd]:n.LEQUAL,[e_]:n.EQUAL,[Pd]:n.GEQUAL,[t_]:n.GREATER,[n_]:n.NOTEQUAL};function Ke(C,w){if(w.type===Vn&&e.has("OES_texture_float_linear")===!1&&(w.magFilter===on||w.magFilter===Yl||w.magFilter===Na||w.magFilter===Ui||w.minFilter===on||w.minFilter===Yl||w.minFilter===Na||w.minFilter===Ui)&&Le("WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),n.texParameteri(C,n.TEXTURE_WRAP_S,Ie[w.wrapS]),n.texParameteri(C,n.TEXTURE_WRAP_T,Ie[w.wrapT]),(C===n.TEXTURE_3D||C===n.TEXTURE_2D_ARRAY)&&n.texParameteri(C,n.TEXTURE_WRAP_R,Ie[w.wrapR]),n.texParameteri(C,n.TEXTURE_MAG_FILTER,_t[w.magFilter]),n.texParameteri(C,n.TEXTURE_MIN_FILTER,_t[w.minFilter]),w.compareFunction&&(n.texParameteri(C,n.TEXTURE_COMPARE_MODE,n.COMPARE_REF_TO_TEXTURE),n.texParameteri(C,n.TEXTURE_COMPARE_FUNC,Re[w.compareFunction])),e.has("EXT_texture_filter_anisotropic")===!0){if(w.magFilter===kt||w.minFilter!==Na&&w.minFilter!==Ui||w.type===Vn&&e.has("OES_texture_float_linear")===!1)return;if(w.anisotropy>1||i.get(w).__currentAnisotropy){const H=e.get("EXT_texture_filter_anisotropic");n.texParameterf(C,H.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(w.anisotropy,r.getMaxAnisotropy())),i.get(w).__currentAnisotropy=w.anisotropy}}}function st(C,w){let H=!1;C.__webglInit===void 0&&(C.__webglInit=!0,w.addEventListener("dispose",P),I(w));const ne=w.source;let Q=h.get(ne);Q===void 0&&(Q={},h.set(ne,Q));const ae=Z(w);if(ae!==C.__cacheKey){Q[ae]===void 0&&(Q[ae]={texture:n.createTexture(),usedTimes:0},a.memory.textures++,H=!0),Q[ae].usedTimes++;const de=Q[C.__cacheKey];de!==void 0&&(Q[C.__cacheKey].usedTimes--,de.usedTimes===0&&W(w)),C.__cacheKey=ae,C.__webglTexture=Q[ae].texture}return H}function $e(C,w,H){return Math.floor(Math.floor(C/H)/w)}function Gt(C,w,H,ne){const ae=C.updateRanges;if(ae.length===0)t.texSubImage2D(n.TEXTURE_2D,0,0,0,w.width,w.height,H,ne,w.data);else{ae.sort((U,J)=>U.start-J.start);let de=0;for(let U=1;U<ae.length;U++){const J=ae[de],q=ae[U],ce=J.start+J.count,se=$e(q.start,w.width,4),oe=$e(J.start,w.width,4);q.start<=ce+1&&se===oe&&$e(q.start+q.count-1,w.width,4)===se?J.count=Math.max(J.count,q.start+q.count-J.start):(++de,ae[de]=q)}ae.length=de+1;const Y=t.getParameter(n.UNPACK_ROW_LENGTH),K=t.getParameter(n.UNPACK_SKIP_PIXELS),le=t.getParameter(n.UNPACK_SKIP_ROWS);t.pixelStorei(n.UNPACK_ROW_LENGTH,w.width);for(let U=0,J=ae.length;U<J;U++){const q=ae[U],ce=Math.floor(q.start/4),se=Math.ceil(q.count/4),oe=ce%w.width,we=Math.floor(ce/w.width),Ge=se,ie=1;t.pixelStorei(n.UNPACK_SKIP_PIXELS,oe),t.pixelStorei(n.UNPACK_SKIP_ROWS,we),t.texSubImage2D(n.TEXTURE_2D,0,oe,we,Ge,ie,H,ne,w.data)}C.clearUpdateRanges(),t.pixelStorei(n.UNPACK_ROW_LENGTH,Y),t.pixelStorei(n.UNPACK_SKIP_PIXELS,K),t.pixelStorei(n.UNPACK_SKIP_ROWS,le)}}function Lt(C,w,H){let ne=n.TEXTURE_2D;(w.isDataArrayTexture||w.isCompressedArrayTexture)&&(ne=n.TEXTURE_2D_ARRAY),w.isData3DTexture&&(ne=n.TEXTURE_3D);const Q=st(C,w),ae=w.source;t.bindTexture(ne,C.__webglTexture,n.TEXTURE0+H);const de=i.get(ae);if(ae.version!==de.__version||Q===!0){if(t.activeTexture(n.TEXTURE0+H),(typeof ImageBitmap<"u"&&w.image instanceof ImageBitmap)===!1){const ie=Ye.getPrimaries(Ye.workingColorSpace),Te=w.colorSpace===Bi?null:Ye.getPrimaries(w.colorSpace),ke=w.colorSpace===Bi||ie===Te?n.NONE:n.BROWSER_DEFAULT_WEBGL;t.pixelStorei(n.UNPACK_FLIP_Y_WEBGL,w.flipY),t.pixelStorei(n.UNPACK_PREMULTIPLY_ALPHA_WEBGL,w.premultiplyAlpha),t.pixelStorei(n.UNPACK_COLORSPACE_CONVERSION_WEBGL,ke)}t.pixelStorei(n.UNPACK_ALIGNMENT,w.unpackAlignment);let K=v(w.image,!1,r.maxTextureSize);K=Ce(w,K);const le=s.convert(w.format,w.colorSpace),U=s.convert(w.type);let J=A(w.internalFormat,le,U,w.normalized,w.colorSpace,w.isVideoTexture);Ke(ne,w);let q;const ce=w.mipmaps,se=w.isVideoTexture!==!0,oe=de.__version===void 0||Q===!0,we=ae.dataReady,Ge=b(w,K);if(w.isDepthTexture)J=_(w.format===Oi,w.type),oe&&(se?t.texStorage2D(n.TEXTURE_2D,1,J,K.width,K.height):t.texImage2D(n.TEXTURE_2D,0,J,K.width,K.height,0,le,U,null));else if(w.isDataTexture)if(ce.length>0){se&&oe&&t.texStorage2D(n.TEXTURE_2D,Ge,J,ce[0].width,ce[0].height);for(let ie=0,Te=ce.length;ie<Te;ie++)q=ce[ie],se?we&&t.texSubImage2D(n.TEXTURE_2D,ie,0,0,q.width,q.height,le,U,q.data):t.texImage2D(n.TEXTURE_2D,ie,J,q.width,q.height,0,le,U,q.data);w.generateMipmaps=!1}else se?(oe&&t.texStorage2D(n.TEXTURE_2D,Ge,J,K.width,K.height),we&&Gt(w,K,le,U)):t.texImage2D(n.TEXTURE_2D,0,J,K.width,K.height,0,le,U,K.data);else if(w.isCompressedTexture)if(w.isCompressedArrayTexture){se&&oe&&t.texStorage3D(n.TEXTURE_2D_ARRAY,Ge,J,ce[0].width,ce[0].height,K.depth);for(let ie=0,Te=ce.length;ie<Te;ie++)if(q=ce[ie],w.format!==$n)if(le!==null)if(se){if(we)if(w.layerUpdates.size>0){const ke=gh(q.width,q.height,w.format,w.type);for(const _e of w.layerUpdates){const rt=q.data.subarray(_e*ke/q.data.BYTES_PER_ELEMENT,(_e+1)*ke/q.data.BYTES_PER_ELEMENT);t.compressedTexSubImage3D(n.TEXTURE_2D_ARRAY,ie,0,0,_e,q.width,q.height,1,le,rt)}}else t.compressedTexSubImage3D(n.TEXTURE_2D_ARRAY,ie,0,0,0,q.width,q.height,K.depth,le,q.data)}else t.compressedTexImage3D(n.TEXTURE_2D_ARRAY,ie,J,q.width,q.height,K.depth,0,q.data,0,0);else Le("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else se?we&&t.texSubImage3D(n.TEXTURE_2D_ARRAY,ie,0,0,0,q.width,q.height,K.depth,le,U,q.data):t.texImage3D(n.TEXTURE_2D_ARRAY,ie,J,q.width,q.height,K.depth,0,le,U,q.data);w.layerUpdates.size>0&&w.clearLayerUpdates()}else{se&&oe&&t.texStorage2D(n.TEXTURE_2D,Ge,J,ce[0].width,ce[0].height);for(let ie=0,Te=ce.length;ie<Te;ie++)q=ce[ie],w.format!==$n?le!==null?se?we&&t.compressedTexSubImage2D(n.TEXTURE_2D,ie,0,0,q.width,q.height,le,q.data):t.compressedTexImage2D(n.TEXTURE_2D,ie,J,q.width,q.height,0,q.data):Le("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):se?we&&t.texSubImage2D(n.TEXTURE_2D,ie,0,0,q.width,q.height,le,U,q.data):t.texImage2D(n.TEXTURE_2D,ie,J,q.width,q.height,0,le,U,q.data)}else if(w.isDataArrayTexture)if(se){if(oe&&t.texStorage3D(n.TEXTURE_2D_ARRAY,Ge,J,K.width,K.height,K.depth),we)if(w.layerUpdates.size>0){const ie=gh(K.width,K.height,w.format,w.type);for(const Te of w.layerUpdates){const ke=K.data.subarray(Te*ie/K.data.BYTES_PER_ELEMENT,(Te+1)*ie/K.data.BYTES_PER_ELEMENT);t.texSubImage3D(n.TEXTURE_2D_ARRAY,0,0,0,Te,K.width,K.height,1,le,U,ke)}w.clearLayerUpdates()}else t.texSubImage3D(n.TEXTURE_2D_ARRAY,0,0,0,0,K.width,K.height,K.depth,le,U,K.data)}else t.texImage3D(n.TEXTURE_2D_ARRAY,0,J,K.width,K.height,K.depth,0,le,U,K.data);else if(w.isData3DTexture)se?(oe&&t.texStorage3D(n.TEXTURE_3D,Ge,J,K.width,K.height,K.depth),we&&t.texSubImage3D(n.TEXTURE_3D,0,0,0,0,K.width,K.height,K.depth,le,U,K.data)):t.texImage3D(n.TEXTURE_3D,0,J,K.width,K.height,K.depth,0,le,U,K.data);else if(w.isFramebufferTexture){if(oe)if(se)t.texStorage2D(n.TEXTURE_2D,Ge,J,K.width,K.height);else{let ie=K.width,Te=K.height;for(let ke=0;ke<Ge;ke++)t.texImage2D(n.TEXTURE_2D,ke,J,ie,Te,0,le,U,null),ie>>=1,Te>>=1}}else if(w.isHTMLTexture){if("texElementImage2D"in n){const ie=n.canvas;if(ie.hasAttribute("layoutsubtree")||ie.setAttribute("layoutsubtree","true"),K.parentNode!==ie){ie.appendChild(K),d.add(w),ie.onpaint=Te=>{const ke=Te.changedElements;for(const _e of d)ke.includes(_e.image)&&(_e.needsUpdate=!0)},ie.requestPaint();return}if(n.texElementImage2D.length===3)n.texElementImage2D(n.TEXTURE_2D,n.RGBA8,K);else{const ke=n.RGBA,_e=n.RGBA,rt=n.UNSIGNED_BYTE;n.texElementImage2D(n.TEXTURE_2D,0,ke,_e,rt,K)}n.texParameteri(n.TEXTURE_2D,n.TEXTURE_MIN_FILTER,n.LINEAR),n.texParameteri(n.TEXTURE_2D,n.TEXTURE_WRAP_S,n.CLAMP_TO_EDGE),n.texParameteri(n.TEXTURE_2D,n.TEXTURE_WRAP_T,n.CLAMP_TO_EDGE)}}else if(ce.length>0){if(se&&oe){const ie=Ne(ce[0]);t.texStorage2D(n.TEXTURE_2D,Ge,J,ie.width,ie.height)}for(let ie=0,Te=ce.length;ie<Te;ie++)q=ce[ie],se?we&&t.texSubImage2D(n.TEXTURE_2D,ie,0,0,le,U,q):t.texImage2D(n.TEXTURE_2D,ie,J,le,U,q);w.generateMipmaps=!1}else if(se){if(oe){const ie=Ne(K);t.texStorage2D(n.TEXTURE_2D,Ge,J,ie.width,ie.height)}we&&t.texSubImage2D(n.TEXTURE_2D,0,0,0,le,U,K)}else t.texImage2D(n.TEXTURE_2D,0,J,le,U,K);y(w)&&w.mipmapsAutoUpdate===!0&&S(ne),de.__version=ae.version,w.onUpdate&&w.onUpdate(w)}C.__version=w.version}function cn(C,w,H){if(w.image.length!==6)return;const ne=st(C,w),Q=w.source;t.bindTexture(n.TEXTURE_CUBE_MAP,C.__webglTexture,n.TEXTURE0+H);const ae=i.get(Q);if(Q.version!==ae.__version||ne===!0){t.activeTexture(n.TEXTURE0+H);const de=Ye.getPrimaries(Ye.workingColorSpace),Y=w.colorSpace===Bi?null:Ye.getPrimaries(w.colorSpace),K=w.colorSpace===Bi||de===Y?n.NONE:n.BROWSER_DEFAULT_WEBGL;t.pixelStorei(n.UNPACK_FLIP_Y_WEBGL,w.flipY),t.pixelStorei(n.UNPACK_PREMULTIPLY_ALPHA_WEBGL,w.premultiplyAlpha),t.pixelStorei(n.UNPACK_ALIGNMENT,w.unpackAlignment),t.pixelStorei(n.UNPACK_COLORSPACE_CONVERSION_WEBGL,K);const le=w.isCompressedTexture||w.image[0].isCompressedTexture,U=w.image[0]&&w.image[0].isDataTexture,J=[];for(let _e=0;_e<6;_e++)!le&&!U?J[_e]=v(w.image[_e],!0,r.maxCubemapSize):J[_e]=U?w.image[_e].image:w.image[_e],J[_e]=Ce(w,J[_e]);const q=J[0],ce=s.convert(w.format,w.colorSpace),se=s.convert(w.type);let oe=A(w.internalFormat,ce,se,w.normalized,w.colorSpace);const we=w.isVideoTexture!==!0,Ge=ae.__version===void 0||ne===!0,ie=Q.dataReady;let Te=b(w,q);Ke(n.TEXTURE_CUBE_MAP,w);let ke;if(w.isDepthTexture){if(oe=_(w.format===Oi,w.type),Ge)if(we)t.texStorage2D(n.TEXTURE_CUBE_MAP,1,oe,q.width,q.height);else for(let _e=0;_e<6;_e++)t.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,0,oe,q.width,q.height,0,ce,se,null)}else if(le){we&&Ge&&t.texStorage2D(n.TEXTURE_CUBE_MAP,Te,oe,q.width,q.height);for(let _e=0;_e<6;_e++){ke=J[_e].mipmaps;for(let rt=0;rt<ke.length;rt++){const Ft=ke[rt];w.format!==$n?ce!==null?we?ie&&t.compressedTexSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,rt,0,0,Ft.width,Ft.height,ce,Ft.data):t.compressedTexImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,rt,oe,Ft.width,Ft.height,0,Ft.data):Le("WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):we?ie&&t.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,rt,0,0,Ft.width,Ft.height,ce,se,Ft.data):t.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,rt,oe,Ft.width,Ft.height,0,ce,se,Ft.data)}}}else{if(ke=w.mipmaps,we&&Ge){ke.length>0&&Te++;const _e=Ne(J[0]);t.texStorage2D(n.TEXTURE_CUBE_MAP,Te,oe,_e.width,_e.height)}for(let _e=0;_e<6;_e++)if(U){we?ie&&t.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,0,0,0,J[_e].width,J[_e].height,ce,se,J[_e].data):t.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,0,oe,J[_e].width,J[_e].height,0,ce,se,J[_e].data);for(let rt=0;rt<ke.length;rt++){const rr=ke[rt].image[_e].image;we?ie&&t.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,rt+1,0,0,rr.width,rr.height,ce,se,rr.data):t.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,rt+1,oe,rr.width,rr.height,0,ce,se,rr.data)}}else{we?ie&&t.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,0,0,0,ce,se,J[_e]):t.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,0,oe,ce,se,J[_e]);for(let rt=0;rt<ke.length;rt++){const Ft=ke[rt];we?ie&&t.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,rt+1,0,0,ce,se,Ft.image[_e]):t.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+_e,rt+1,oe,ce,se,Ft.image[_e])}}}y(w)&&w.mipmapsAutoUpdate===!0&&S(n.TEXTURE_CUBE_MAP),ae.__version=Q.version,w.onUpdate&&w.onUpdate(w)}C.__version=w.version}function pt(C,w,H,ne,Q,ae){const de=s.convert(H.format,H.colorSpace),Y=s.convert(H.type),K=A(H.internalFormat,de,Y,H.normalized,H.colorSpace),le=i.get(w),U=i.get(H);if(U.__renderTarget=w,!le.__hasExternalTextures){const J=Math.max(1,w.width>>ae),q=Math.max(1,w.height>>ae);Q===n.TEXTURE_3D||Q===n.TEXTURE_2D_ARRAY?t.texImage3D(Q,ae,K,J,q,w.depth,0,de,Y,null):t.texImage2D(Q,ae,K,J,q,0,de,Y,null)}t.bindFramebuffer(n.FRAMEBUFFER,C),pe(w)?o.framebufferTexture2DMultisampleEXT(n.FRAMEBUFFER,ne,Q,U.__webglTexture,0,dt(w)):(Q===n.TEXTURE_2D||Q>=n.TEXTURE_CUBE_MAP_POSITIVE_X&&Q<=n.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&n.framebufferTexture2D(n.FRAMEBUFFER,ne,Q,U.__webglTexture,ae),t.bindFramebuffer(n.FRAMEBUFFER,null)}function ai(C,w,H){if(n.bindRenderbuffer(n.RENDERBUFFER,C),w.depthBuffer){const ne=w.depthTexture,Q=ne&&ne.isDepthTexture?ne.type:null,ae=_(w.stencilBuffer,Q),de=w.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT;pe(w)?o.renderbufferStorageMultisampleEXT(n.RENDERBUFFER,dt(w),ae,w.width,w.height):H?n.renderbufferStorageMultisample(n.RENDERBUFFER,dt(w),ae,w.width,w.height):n.renderbufferStorage(n.RENDERBUFFER,ae,w.width,w.height),n.framebufferRenderbuffer(n.FRAMEBUFFER,de,n.RENDERBUFFER,C)}else{const ne=w.textures;for(let Q=0;Q<ne.length;Q++){const ae=ne[Q],de=s.convert(ae.format,ae.colorSpace),Y=s.convert(ae.type),K=A(ae.internalFormat,de,Y,ae.normalized,ae.colorSpace);pe(w)?o.renderbufferStorageMultisampleEXT(n.RENDERBUFFER,dt(w),K,w.width,w.height):H?n.renderbufferStorageMultisample(n.RENDERBUFFER,dt(w),K,w.width,w.height):n.renderbufferStorage(n.RENDERBUFFER,K,w.width,w.height)}}n.bindRenderbuffer(n.RENDERBUFFER,null)}function Ut(C,w,H){const ne=w.isWebGLCubeRenderTarget===!0;if(t.bindFramebuffer(n.FRAMEBUFFER,C),!(w.depthTexture&&w.depthTexture.isDepthTexture))throw new Error("THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.");const Q=i.get(w.depthTexture);Q.__renderTarget=w;const ae=ne?w.depthTexture.image[0]:w.depthTexture.image;(!Q.__webglTexture||ae.width!==w.width||ae.height!==w.height)&&(ae.width=w.width,ae.height=w.height,w.depthTexture.needsUpdate=!0),ne?ge(w.depthTexture,0):fe(w.depthTexture,0);const de=Q.__webglTexture,Y=dt(w),K=ne?n.TEXTURE_CUBE_MAP_POSITIVE_X+H:n.TEXTURE_2D,le=w.depthTexture.format===Oi?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT;if(w.depthTexture.format===Fi)pe(w)?o.framebufferTexture2DMultisampleEXT(n.FRAMEBUFFER,le,K,de,0,Y):n.framebufferTexture2D(n.FRAMEBUFFER,le,K,de,0);else if(w.depthTexture.format===Oi)pe(w)?o.framebufferTexture2DMultisampleEXT(n.FRAMEBUFFER,le,K,de,0,Y):n.framebufferTexture2D(n.FRAMEBUFFER,le,K,de,0);else throw new Error("THREE.WebGLTextures: Unknown depthTexture format.")}function An(C){const w=i.get(C),H=C.isWebGLCubeRenderTarget===!0;if(w.__boundDepthTexture!==C.depthTexture){const ne=C.depthTexture;if(w.__depthDisposeCallback&&w.__depthDisposeCallback(),ne){const Q=()=>{delete w.__boundDepthTexture,delete w.__depthDisposeCallback,ne.removeEventListener("dispose",Q)};ne.addEventListener("dispose",Q),w.__depthDisposeCallback=Q}w.__boundDepthTexture=ne}if(C.depthTexture&&!w.__autoAllocateDepthBuffer)if(H)for(let ne=0;ne<6;ne++)Ut(w.__webglFramebuffer[ne],C,ne);else C.texture.mipmaps.length>0?Ut(w.__webglFramebuffer[0],C,0):Ut(w.__webglFramebuffer,C,0);else if(H){w.__webglDepthbuffer=[];for(let ne=0;ne<6;ne++)if(t.bindFramebuffer(n.FRAMEBUFFER,w.__webglFramebuffer[ne]),w.__webglDepthbuffer[ne]===void 0)w.__webglDepthbuffer[ne]=n.createRenderbuffer(),ai(w.__webglDepthbuffer[ne],C,!1);else{const Q=C.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT,ae=w.__webglDepthbuffer[ne];n.bindRenderbuffer(n.RENDERBUFFER,ae),n.framebufferRenderbuffer(n.FRAMEBUFFER,Q,n.RENDERBUFFER,ae)}}else if(C.texture.mipmaps.length>0?t.bindFramebuffer(n.FRAMEBUFFER,w.__webglFramebuffer[0]):t.bindFramebuffer(n.FRAMEBUFFER,w.__webglFramebuffer),w.__webglDepthbuffer===void 0)w.__webglDepthbuffer=n.createRenderbuffer(),ai(w.__webglDepthbuffer,C,!1);else{const Q=C.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT,ae=w.__webglDepthbuffer;n.bindRenderbuffer(n.RENDERBUFFER,ae),n.framebufferRenderbuffer(n.FRAMEBUFFER,Q,n.RENDERBUFFER,ae)}t.bindFramebuffer(n.FRAMEBUFFER,null)}function Rn(C,w,H){const ne=i.get(C);w!==void 0&&pt(ne.__webglFramebuffer,C,C.texture,n.COLOR_ATTACHMENT0,n.TEXTURE_2D,0),H!==void 0&&An(C)}function Cn(C){const w=C.texture,H=i.get(C),ne=i.get(w);C.addEventListener("dispose",D),I(C);const Q=C.textures,ae=C.isWebGLCubeRenderTarget===!0,de=Q.length>1;if(de||(ne.__webglTexture===void 0&&(ne.__webglTexture=n.createTexture()),ne.__version=w.version,a.memory.textures++),ae){H.__webglFramebuffer=[];for(let Y=0;Y<6;Y++)if(w.mipmaps.length>0){H.__webglFramebuffer[Y]=[];for(let K=0;K<w.mipmaps.length;K++)H.__webglFramebuffer[Y][K]=n.createFramebuffer()}else H.__webglFramebuffer[Y]=n.createFramebuffer()}else{if(w.mipmaps.length>0){H.__webglFramebuffer=[];for(let Y=0;Y<w.mipmaps.length;Y++)H.__webglFramebuffer[Y]=n.createFramebuffer()}else H.__webglFramebuffer=n.createFramebuffer();if(de)for(let Y=0,K=Q.length;Y<K;Y++){const le=i.get(Q[Y]);le.__webglTexture===void 0&&(le.__webglTexture=n.createTexture(),a.memory.textures++)}if(C.samples>0&&pe(C)===!1){H.__webglMultisampledFramebuffer=n.createFramebuffer(),H.__webglColorRenderbuffer=[],t.bindFramebuffer(n.FRAMEBUFFER,H.__webglMultisampledFramebuffer);for(let Y=0;Y<Q.length;Y++){const K=Q[Y];H.__webglColorRenderbuffer[Y]=n.createRenderbuffer(),n.bindRenderbuffer(n.RENDERBUFFER,H.__webglColorRenderbuffer[Y]);const le=s.convert(K.format,K.colorSpace),U=s.convert(K.type),J=A(K.internalFormat,le,U,K.normalized,K.colorSpace,C.isXRRenderTarget===!0),q=dt(C);n.renderbufferStorageMultisample(n.RENDERBUFFER,q,J,C.width,C.height),n.framebufferRenderbuffer(n.FRAMEBUFFER,n.COLOR_ATTACHMENT0+Y,n.RENDERBUFFER,H.__webglColorRenderbuffer[Y])}n.bindRenderbuffer(n.RENDERBUFFER,null),C.depthBuffer&&(H.__webglDepthRenderbuffer=n.createRenderbuffer(),ai(H.__webglDepthRenderbuffer,C,!0)),t.bindFramebuffer(n.FRAMEBUFFER,null)}}if(ae){t.bindTexture(n.TEXTURE_CUBE_MAP,ne.__webglTexture),Ke(n.TEXTURE_CUBE_MAP,w);for(let Y=0;Y<6;Y++)if(w.mipmaps.length>0)for(let K=0;K<w.mipmaps.length;K++)pt(H.__webglFramebuffer[Y][K],C,w,n.COLOR_ATTACHMENT0,n.TEXTURE_CUBE_MAP_POSITIVE_X+Y,K);else pt(H.__webglFramebuffer[Y],C,w,n.COLOR_ATTACHMENT0,n.TEXTURE_CUBE_MAP_POSITIVE_X+Y,0);y(w)?S(n.TEXTURE_CUBE_MAP):w.mipmaps.length>0&&n.texParameteri(n.TEXTURE_CUBE_MAP,n.TEXTURE_MAX_LEVEL,w.mipmaps.length-1),t.unbindTexture()}else if(de){for(let Y=0,K=Q.length;Y<K;Y++){const le=Q[Y],U=i.get(le);let J=n.TEXTURE_2D;(C.isWebGL3DRenderTarget||C.isWebGLArrayRenderTarget)&&(J=C.isWebGL3DRenderTarget?n.TEXTURE_3D:n.TEXTURE_2D_ARRAY),t.bindTexture(J,U.__webglTexture),Ke(J,le),pt(H.__webglFramebuffer,C,le,n.COLOR_ATTACHMENT0+Y,J,0),y(le)&&S(J)}t.unbindTexture()}else{let Y=n.TEXTURE_2D;if((C.isWebGL3DRenderTarget||C.isWebGLArrayRenderTarget)&&(Y=C.isWebGL3DRenderTarget?n.TEXTURE_3D:n.TEXTURE_2D_ARRAY),t.bindTexture(Y,ne.__webglTexture),Ke(Y,w),w.mipmaps.length>0)for(let K=0;K<w.mipmaps.length;K++)pt(H.__webglFramebuffer[K],C,w,n.COLOR_ATTACHMENT0,Y,K);else pt(H.__webglFramebuffer,C,w,n.COLOR_ATTACHMENT0,Y,0);y(w)?S(Y):w.mipmaps.length>0&&n.texParameteri(Y,n.TEXTURE_MAX_LEVEL,w.mipmaps.length-1),t.unbindTexture()}C.depthBuffer&&An(C)}function B(C){const w=C.textures;for(let H=0,ne=w.length;H<ne;H++){const Q=w[H];if(y(Q)&&Q.mipmapsAutoUpdate===!0){const ae=E(C),de=i.get(Q).__webglTexture;t.bindTexture(ae,de),S(ae),t.unbindTexture()}}}const Pn=[];function ft(C){if(C.samples>0){if(pe(C)===!1){const w=C.textures,H=C.width,ne=C.height;let Q=n.COLOR_BUFFER_BIT;const ae=C.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT,de=i.get(C),Y=w.length>1;if(Y)for(let le=0;le<w.length;le++)t.bindFramebuffer(n.FRAMEBUFFER,de.__webglMultisampledFramebuffer),n.framebufferRenderbuffer(n.FRAMEBUFFER,n.COLOR_ATTACHMENT0+le,n.RENDERBUFFER,null),t.bindFramebuffer(n.FRAMEBUFFER,de.__webglFramebuffer),n.framebufferTexture2D(n.DRAW_FRAMEBUFFER,n.COLOR_ATTACHMENT0+le,n.TEXTURE_2D,null,0);t.bindFramebuffer(n.READ_FRAMEBUFFER,de.__webglMultisampledFramebuffer),C.texture.mipmaps.length>0?t.bindFramebuffer(n.DRAW_FRAMEBUFFER,de.__webglFramebuffer[0]):t.bindFramebuffer(n.DRAW_FRAMEBUFFER,de.__webglFramebuffer);for(let le=0;le<w.length;le++){if(C.resolveDepthBuffer&&(C.depthBuffer&&(Q|=n.DEPTH_BUFFER_BIT),C.stencilBuffer&&C.resolveStencilBuffer&&(Q|=n.STENCIL_BUFFER_BIT)),Y){n.framebufferRenderbuffer(n.READ_FRAMEBUFFER,n.COLOR_ATTACHMENT0,n.RENDERBUFFER,de.__webglColorRenderbuffer[le]);const U=i.get(w[le]).__webglTexture;n.framebufferTexture2D(n.DRAW_FRAMEBUFFER,n.COLOR_ATTACHMENT0,n.TEXTURE_2D,U,0)}n.blitFramebuffer(0,0,H,ne,0,0,H,ne,Q,n.NEAREST),l===!0&&(Pn.length=0,Pn.push(n.COLOR_ATTACHMENT0+le),C.depthBuffer&&C.storeMultisampledDepthBuffer===!1&&Pn.push(ae),n.invalidateFramebuffer(n.READ_FRAMEBUFFER,Pn))}if(t.bindFramebuffer(n.READ_FRAMEBUFFER,null),t.bindFramebuffer(n.DRAW_FRAMEBUFFER,null),Y)for(let le=0;le<w.length;le++){t.bindFramebuffer(n.FRAMEBUFFER,de.__webglMultisampledFramebuffer),n.framebufferRenderbuffer(n.FRAMEBUFFER,n.COLOR_ATTACHMENT0+le,n.RENDERBUFFER,de.__webglColorRenderbuffer[le]);const U=i.get(w[le]).__webglTexture;t.bindFramebuffer(n.FRAMEBUFFER,de.__webglFramebuffer),n.framebufferTexture2D(n.DRAW_FRAMEBUFFER,n.COLOR_ATTACHMENT0+le,n.TEXTURE_2D,U,0)}t.bindFramebuffer(n.DRAW_FRAMEBUFFER,de.__webglMultisampledFramebuffer)}else if(C.depthBuffer&&C.storeMultisampledDepthBuffer===!1&&l){const w=C.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT;n.invalidateFramebuffer(n.DRAW_FRAMEBUFFER,[w])}}}function dt(C){return Math.min(r.maxSamples,C.samples)}function pe(C){const w=i.get(C);return C.samples>0&&e.has("WEBGL_multisampled_render_to_texture")===!0&&w.__useRenderToTexture!==!1}function Dt(C){const w=a.render.frame;f.get(C)!==w&&(f.set(C,w),C.update())}function Ce(C,w){const H=C.colorSpace,ne=C.format,Q=C.type;return C.isCompressedTexture===!0||C.isVideoTexture===!0||H!==Ha&&H!==Bi&&(Ye.getTransfer(H)===nt?(ne!==$n||Q!==xn)&&Le("WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):Qe("WebGLTextures: Unsupported texture color space:",H)),w}function Ne(C){return typeof HTMLImageElement<"u"&&C instanceof HTMLImageElement?(c.width=C.naturalWidth||C.width,c.height=C.naturalHeight||C.height):typeof VideoFrame<"u"&&C instanceof VideoFrame?(c.width=C.displayWidth,c.height=C.displayHeight):(c.width=C.width,c.height=C.height),c}this.allocateTextureUnit=De,this.resetTextureUnits=j,this.getTextureUnits=ee,this.setTextureUnits=Se,this.setTexture2D=fe,this.setTexture2DArray=xe,this.setTexture3D=Ae,this.setTextureCube=ge,this.rebindTextures=Rn,this.setupRenderTarget=Cn,this.updateRenderTargetMipmap=B,this.updateMultisampleRenderTarget=ft,this.setupDepthRenderbuffer=An,this.setupFrameBufferTexture=pt,this.useMultisampledRTT=pe,this.dispose=k}function JS(n,e){function t(i,r=Bi){let s;const a=Ye.getTransfer(r);if(i===xn)return n.UNSIGNED_BYTE;if(i===Zl)return n.UNSIGNED_SHORT_4_4_4_4;if(i===Jl)return n.UNSIGNED_SHORT_5_5_5_1;if(i===bd)return n.UNSIGNED_INT_5_9_9_9_REV;if(i===Ed)return n.UNSIGNED_INT_10F_11F_11F_REV;if(i===Md)return n.BYTE;if(i===yd)return n.SHORT;if(i===Gs)return n.UNSIGNED_SHORT;if(i===Kl)return n.INT;if(i===Gn)return n.UNSIGNED_INT;if(i===Vn)return n.FLOAT;if(i===Wn)return n.HALF_FLOAT;if(i===wd)return n.ALPHA;if(i===Td)return n.RGB;if(i===$n)return n.RGBA;if(i===Fi)return n.DEPTH_COMPONENT;if(i===Oi)return n.DEPTH_STENCIL;if(i===Ad)return n.RED;if(i===Ql)return n.RED_INTEGER;if(i===hr)return n.RG;if(i===jl)return n.RG_INTEGER;if(i===ec)return n.RGBA_INTEGER;if(i===Ua||i===Fa||i===Oa||i===Ba)if(a===nt)if(s=e.get("WEBGL_compressed_texture_s3tc_srgb"),s!==null){if(i===Ua)return s.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(i===Fa)return s.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(i===Oa)return s.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(i===Ba)return s.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(s=e.get("WEBGL_compressed_texture_s3tc"),s!==null){if(i===Ua)return s.COMPRESSED_RGB_S3TC_DXT1_EXT;if(i===Fa)return s.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(i===Oa)return s.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(i===Ba)return s.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(i===tc||i===nc||i===ic||i===rc)if(s=e.get("WEBGL_compressed_texture_pvrtc"),s!==null){if(i===tc)return s.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(i===nc)return s.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(i===ic)return s.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(i===rc)return s.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(i===sc||i===ac||i===oc||i===lc||i===cc||i===ka||i===uc)if(s=e.get("WEBGL_compressed_texture_etc"),s!==null){if(i===sc||i===ac)return a===nt?s.COMPRESSED_SRGB8_ETC2:s.COMPRESSED_RGB8_ETC2;if(i===oc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:s.COMPRESSED_RGBA8_ETC2_EAC;if(i===lc)return s.COMPRESSED_R11_EAC;if(i===cc)return s.COMPRESSED_SIGNED_R11_EAC;if(i===ka)return s.COMPRESSED_RG11_EAC;if(i===uc)return s.COMPRESSED_SIGNED_RG11_EAC}else return null;if(i===fc||i===dc||i===hc||i===pc||i===mc||i===gc||i===_c||i===vc||i===xc||i===Sc||i===Mc||i===yc||i===bc||i===Ec)if(s=e.get("WEBGL_compressed_texture_astc"),s!==null){if(i===fc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:s.COMPRESSED_RGBA_ASTC_4x4_KHR;if(i===dc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:s.COMPRESSED_RGBA_ASTC_5x4_KHR;if(i===hc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:s.COMPRESSED_RGBA_ASTC_5x5_KHR;if(i===pc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:s.COMPRESSED_RGBA_ASTC_6x5_KHR;if(i===mc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:s.COMPRESSED_RGBA_ASTC_6x6_KHR;if(i===gc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:s.COMPRESSED_RGBA_ASTC_8x5_KHR;if(i===_c)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:s.COMPRESSED_RGBA_ASTC_8x6_KHR;if(i===vc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:s.COMPRESSED_RGBA_ASTC_8x8_KHR;if(i===xc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:s.COMPRESSED_RGBA_ASTC_10x5_KHR;if(i===Sc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:s.COMPRESSED_RGBA_ASTC_10x6_KHR;if(i===Mc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:s.COMPRESSED_RGBA_ASTC_10x8_KHR;if(i===yc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:s.COMPRESSED_RGBA_ASTC_10x10_KHR;if(i===bc)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:s.COMPRESSED_RGBA_ASTC_12x10_KHR;if(i===Ec)return a===nt?s.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:s.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(i===wc||i===Tc||i===Ac)if(s=e.get("EXT_texture_compression_bptc"),s!==null){if(i===wc)return a===nt?s.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:s.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(i===Tc)return s.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(i===Ac)return s.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(i===Rc||i===Cc||i===za||i===Pc)if(s=e.get("EXT_texture_compression_rgtc"),s!==null){if(i===Rc)return s.COMPRESSED_RED_RGTC1_EXT;if(i===Cc)return s.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(i===za)return s.COMPRESSED_RED_GREEN_RGTC2_EXT;if(i===Pc)return s.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return i===Wr?n.UNSIGNED_INT_24_8:n[i]!==void 0?n[i]:null}return{convert:t}}const QS=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,jS=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`;class eM{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(e,t){if(this.texture===null){const i=new ch(e.texture);(e.depthNear!==t.depthNear||e.depthFar!==t.depthFar)&&(this.depthNear=e.depthNear,this.depthFar=e.depthFar),this.texture=i}}getMesh(e){if(this.texture!==null&&this.mesh===null){const t=e.cameras[0].viewport,i=new Wi({vertexShader:QS,fragmentShader:jS,uniforms:{depthColor:{value:this.texture},depthWidth:{value:t.z},depthHeight:{value:t.w}}});this.mesh=new yi(new vo(20,20),i)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}}class tM extends pr{constructor(e,t){super();const i=this;let r=null,s=1,a=null,o="local-floor",l=1,c=null,f=null,d=null,u=null,h=null,g=null;const x=typeof XRWebGLBinding<"u",m=new eM,p={},v=t.getContextAttributes();let y=null,S=null;const E=[],A=[],_=new We;let b=null,I=null;const R=new yn;R.viewport=new ot;const P=new yn;P.viewport=new ot;const D=[R,P],O=new $_;let L=null,k=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(Z){let fe=E[Z];return fe===void 0&&(fe=new Vc,E[Z]=fe),fe.getTargetRaySpace()},this.getControllerGrip=function(Z){let fe=E[Z];return fe===void 0&&(fe=new Vc,E[Z]=fe),fe.getGripSpace()},this.getHand=function(Z){let fe=E[Z];return fe===void 0&&(fe=new Vc,E[Z]=fe),fe.getHandSpace()};function V(Z){const fe=A.indexOf(Z.inputSource);if(fe===-1)return;const xe=E[fe];xe!==void 0&&(xe.update(Z.inputSource,Z.frame,c||a),xe.dispatchEvent({type:Z.type,data:Z.inputSource}))}function W(){r.removeEventListener("select",V),r.removeEventListener("selectstart",V),r.removeEventListener("selectend",V),r.removeEventListener("squeeze",V),r.removeEventListener("squeezestart",V),r.removeEventListener("squeezeend",V),r.removeEventListener("end",W),r.removeEventListener("inputsourceschange",te);for(let Z=0;Z<E.length;Z++){const fe=A[Z];fe!==null&&(A[Z]=null,E[Z].disconnect(fe))}L=null,k=null,m.reset();for(const Z in p)delete p[Z];if(e.setRenderTarget(y),h=null,u=null,d=null,r=null,S=null,De.stop(),i.isPresenting=!1,e.setPixelRatio(b),e.setSize(_.width,_.height,!1),I!==null){const Z=I.camera;Z.fov=I.fov,Z.zoom=I.zoom,Z.updateProjectionMatrix(),I=null}i.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(Z){s=Z,i.isPresenting===!0&&Le("WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(Z){o=Z,i.isPresenting===!0&&Le("WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return c||a},this.setReferenceSpace=function(Z){c=Z},this.getBaseLayer=function(){return u!==null?u:h},this.getBinding=function(){return d===null&&x&&(d=new XRWebGLBinding(r,t)),d},this.getFrame=function(){return g},this.getSession=function(){return r},this.setSession=async function(Z){if(r=Z,r!==null){if(y=e.getRenderTarget(),r.addEventListener("select",V),r.addEventListener("selectstart",V),r.addEventListener("selectend",V),r.addEventListener("squeeze",V),r.addEventListener("squeezestart",V),r.addEventListener("squeezeend",V),r.addEventListener("end",W),r.addEventListener("inputsourceschange",te),v.xrCompatible!==!0&&await t.makeXRCompatible(),b=e.getPixelRatio(),e.getSize(_),x&&"createProjectionLayer"in XRWebGLBinding.prototype){let xe=null,Ae=null,ge=null;v.depth&&(ge=v.stencil?t.DEPTH24_STENCIL8:t.DEPTH_COMPONENT24,xe=v.stencil?Oi:Fi,Ae=v.stencil?Wr:Gn);const Ie={colorFormat:t.RGBA8,depthFormat:ge,scaleFactor:s};d=this.getBinding(),u=d.createProjectionLayer(Ie),r.updateRenderState({layers:[u]}),e.setPixelRatio(1),e.setSize(u.textureWidth,u.textureHeight,!1),S=new Dn(u.textureWidth,u.textureHeight,{format:$n,type:xn,depthTexture:new ns(u.textureWidth,u.textureHeight,Ae,void 0,void 0,void 0,void 0,void 0,void 0,xe),stencilBuffer:v.stencil,colorSpace:e.outputColorSpace,samples:v.antialias?4:0,resolveDepthBuffer:u.ignoreDepthValues===!1,resolveStencilBuffer:u.ignoreDepthValues===!1,storeMultisampledDepthBuffer:u.ignoreDepthValues===!1,storeMultisampledStencilBuffer:u.ignoreDepthValues===!1})}else{const xe={antialias:v.antialias,alpha:!0,depth:v.depth,stencil:v.stencil,framebufferScaleFactor:s};h=new XRWebGLLayer(r,t,xe),r.updateRenderState({baseLayer:h}),e.setPixelRatio(1),e.setSize(h.framebufferWidth,h.framebufferHeight,!1),S=new Dn(h.framebufferWidth,h.framebufferHeight,{format:$n,type:xn,colorSpace:e.outputColorSpace,stencilBuffer:v.stencil,resolveDepthBuffer:h.ignoreDepthValues===!1,resolveStencilBuffer:h.ignoreDepthValues===!1,storeMultisampledDepthBuffer:h.ignoreDepthValues===!1,storeMultisampledStencilBuffer:h.ignoreDepthValues===!1})}S.isXRRenderTarget=!0,this.setFoveation(l),c=null,a=await r.requestReferenceSpace(o),De.setContext(r),De.start(),i.isPresenting=!0,i.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(r!==null)return r.environmentBlendMode},this.getDepthTexture=function(){return m.getDepthTexture()};function te(Z){for(let fe=0;fe<Z.removed.length;fe++){const xe=Z.removed[fe],Ae=A.indexOf(xe);Ae>=0&&(A[Ae]=null,E[Ae].disconnect(xe))}for(let fe=0;fe<Z.added.length;fe++){const xe=Z.added[fe];let Ae=A.indexOf(xe);if(Ae===-1){for(let Ie=0;Ie<E.length;Ie++)if(Ie>=A.length){A.push(xe),Ae=Ie;break}else if(A[Ie]===null){A[Ie]=xe,Ae=Ie;break}if(Ae===-1)break}const ge=E[Ae];ge&&ge.connect(xe)}}function X(Z,fe){fe===null?Z.matrixWorld.copy(Z.matrix):Z.matrixWorld.multiplyMatrices(fe.matrixWorld,Z.matrix),Z.matrixWorldInverse.copy(Z.matrixWorld).invert()}this.updateCamera=function(Z){if(r===null)return;let fe=Z.near,xe=Z.far;m.texture!==null&&(m.depthNear>0&&(fe=m.depthNear),m.depthFar>0&&(xe=m.depthFar)),O.near=P.near=R.near=fe,O.far=P.far=R.far=xe,(L!==O.near||k!==O.far)&&(r.updateRenderState({depthNear:O.near,depthFar:O.far}),L=O.near,k=O.far),O.layers.mask=Z.layers.mask|6,R.layers.mask=O.layers.mask&-5,P.layers.mask=O.layers.mask&-3;const Ae=Z.parent,ge=O.cameras;X(O,Ae);for(let Ie=0;Ie<ge.length;Ie++)X(ge[Ie],Ae);O.projectionMatrix.copy(R.projectionMatrix),O.projectionMatrixInverse.copy(R.projectionMatrixInverse),I===null&&Z.isPerspectiveCamera&&(I={camera:Z,fov:Z.fov,zoom:Z.zoom}),j(Z,O,Ae)};function j(Z,fe,xe){xe===null?Z.matrix.copy(fe.matrixWorld):(Z.matrix.copy(xe.matrixWorld),Z.matrix.invert(),Z.matrix.multiply(fe.matrixWorld)),Z.matrix.decompose(Z.position,Z.quaternion,Z.scale),Z.updateMatrixWorld(!0),Z.projectionMatrix.copy(fe.projectionMatrix),Z.projectionMatrixInverse.copy(fe.projectionMatrixInverse),Z.isPerspectiveCamera&&(Z.fov=Nc*2*Math.atan(1/Z.projectionMatrix.elements[5]),Z.zoom=1)}this.getCamera=function(){return O},this.getFoveation=function(){if(!(u===null&&h===null))return l},this.setFoveation=function(Z){l=Z,u!==null&&(u.fixedFoveation=Z),h!==null&&h.fixedFoveation!==void 0&&(h.fixedFoveation=Z)},this.hasDepthSensing=function(){return m.texture!==null},this.getDepthSensingMesh=function(){return m.getMesh(O)},this.getCameraTexture=function(Z){return p[Z]};let ee=null;function Se(Z,fe){if(f=fe.getViewerPose(c||a),g=fe,f!==null){const xe=f.views;h!==null&&(e.setRenderTargetFramebuffer(S,h.framebuffer),e.setRenderTarget(S));let Ae=!1;xe.length!==O.cameras.length&&(O.cameras.length=0,Ae=!0);for(let Re=0;Re<xe.length;Re++){const Ke=xe[Re];let st=null;if(h!==null)st=h.getViewport(Ke);else{const Gt=d.getViewSubImage(u,Ke);st=Gt.viewport,Re===0&&(e.setRenderTargetTextures(S,Gt.colorTexture,Gt.depthStencilTexture),e.setRenderTarget(S))}let $e=D[Re];$e===void 0&&($e=new yn,$e.layers.enable(Re),$e.viewport=new ot,D[Re]=$e),$e.matrix.fromArray(Ke.transform.matrix),$e.matrix.decompose($e.position,$e.quaternion,$e.scale),$e.projectionMatrix.fromArray(Ke.projectionMatrix),$e.projectionMatrixInverse.copy($e.projectionMatrix).invert(),$e.viewport.set(st.x,st.y,st.width,st.height),Re===0&&(O.matrix.copy($e.matrix),O.matrix.decompose(O.position,O.quaternion,O.scale)),Ae===!0&&O.cameras.push($e)}const ge=r.enabledFeatures;if(ge&&ge.includes("depth-sensing")&&r.depthUsage=="gpu-optimized"&&x){d=i.getBinding();const Re=d.getDepthInformation(xe[0]);Re&&Re.isValid&&Re.texture&&m.init(Re,r.renderState)}if(ge&&ge.includes("camera-access")&&x){e.state.unbindTexture(),d=i.getBinding();for(let Re=0;Re<xe.length;Re++){const Ke=xe[Re].camera;if(Ke){let st=p[Ke];st||(st=new ch,p[Ke]=st);const $e=d.getCameraImage(Ke);st.sourceTexture=$e}}}}for(let xe=0;xe<E.length;xe++){const Ae=A[xe],ge=E[xe];Ae!==null&&ge!==void 0&&ge.update(Ae,fe,c||a)}ee&&ee(Z,fe),fe.detectedPlanes&&i.dispatchEvent({type:"planesdetected",data:fe}),g=null}const De=new _h;De.setAnimationLoop(Se),this.setAnimationLoop=function(Z){ee=Z},this.dispose=function(){}}}const nM=new tt,Yh=new Fe;Yh.set(-1,0,0,0,1,0,0,0,1);function iM(n,e){function t(m,p){m.matrixAutoUpdate===!0&&m.updateMatrix(),p.value.copy(m.matrix)}function i(m,p){p.color.getRGB(m.fogColor.value,fh(n)),p.isFog?(m.fogNear.value=p.near,m.fogFar.value=p.far):p.isFogExp2&&(m.fogDensity.value=p.density)}function r(m,p,v,y,S){p.isNodeMaterial?p.uniformsNeedUpdate=!1:p.isMeshBasicMaterial?s(m,p):p.isMeshLambertMaterial?(s(m,p),p.envMap&&(m.envMapIntensity.value=p.envMapIntensity)):p.isMeshToonMaterial?(s(m,p),d(m,p)):p.isMeshPhongMaterial?(s(m,p),f(m,p),p.envMap&&(m.envMapIntensity.value=p.envMapIntensity)):p.isMeshStandardMaterial?(s(m,p),u(m,p),p.isMeshPhysicalMaterial&&h(m,p,S)):p.isMeshMatcapMaterial?(s(m,p),g(m,p)):p.isMeshDepthMaterial?s(m,p):p.isMeshDistanceMaterial?(s(m,p),x(m,p)):p.isMeshNormalMaterial?s(m,p):p.isLineBasicMaterial?(a(m,p),p.isLineDashedMaterial&&o(m,p)):p.isPointsMaterial?l(m,p,v,y):p.isSpriteMaterial?c(m,p):p.isShadowMaterial?(m.color.value.copy(p.color),m.opacity.value=p.opacity):p.isShaderMaterial&&(p.uniformsNeedUpdate=!1)}function s(m,p){m.opacity.value=p.opacity,p.color&&m.diffuse.value.copy(p.color),p.emissive&&m.emissive.value.copy(p.emissive).multiplyScalar(p.emissiveIntensity),p.map&&(m.map.value=p.map,t(p.map,m.mapTransform)),p.alphaMap&&(m.alphaMap.value=p.alphaMap,t(p.alphaMap,m.alphaMapTransform)),p.bumpMap&&(m.bumpMap.value=p.bumpMap,t(p.bumpMap,m.bumpMapTransform),m.bumpScale.value=p.bumpScale,p.side===en&&(m.bumpScale.value*=-1)),p.normalMap&&(m.normalMap.value=p.normalMap,t(p.normalMap,m.normalMapTransform),m.normalScale.value.copy(p.normalScale),p.side===en&&m.normalScale.value.negate()),p.displacementMap&&(m.displacementMap.value=p.displacementMap,t(p.displacementMap,m.displacementMapTransform),m.displacementScale.value=p.displacementScale,m.displacementBias.value=p.displacementBias),p.emissiveMap&&(m.emissiveMap.value=p.emissiveMap,t(p.emissiveMap,m.emissiveMapTransform)),p.specularMap&&(m.specularMap.value=p.specularMap,t(p.specularMap,m.specularMapTransform)),p.alphaTest>0&&(m.alphaTest.value=p.alphaTest);const v=e.get(p),y=v.envMap,S=v.envMapRotation;y&&(m.envMap.value=y,m.envMapRotation.value.setFromMatrix4(nM.makeRotationFromEuler(S)).transpose(),y.isCubeTexture&&y.isRenderTargetTexture===!1&&m.envMapRotation.value.premultiply(Yh),m.reflectivity.value=p.reflectivity,m.ior.value=p.ior,m.refractionRatio.value=p.refractionRatio),p.lightMap&&(m.lightMap.value=p.lightMap,m.lightMapIntensity.value=p.lightMapIntensity,t(p.lightMap,m.lightMapTransform)),p.aoMap&&(m.aoMap.value=p.aoMap,m.aoMapIntensity.value=p.aoMapIntensity,t(p.aoMap,m.aoMapTransform))}function a(m,p){m.diffuse.value.copy(p.color),m.opacity.value=p.opacity,p.map&&(m.map.value=p.map,t(p.map,m.mapTransform))}function o(m,p){m.dashSize.value=p.dashSize,m.totalSize.value=p.dashSize+p.gapSize,m.scale.value=p.scale}function l(m,p,v,y){m.diffuse.value.copy(p.color),m.opacity.value=p.opacity,m.size.value=p.size*v,m.scale.value=y*.5,p.map&&(m.map.value=p.map,t(p.map,m.uvTransform)),p.alphaMap&&(m.alphaMap.value=p.alphaMap,t(p.alphaMap,m.alphaMapTransform)),p.alphaTest>0&&(m.alphaTest.value=p.alphaTest)}function c(m,p){m.diffuse.value.copy(p.color),m.opacity.value=p.opacity,m.rotation.value=p.rotation,p.map&&(m.map.value=p.map,t(p.map,m.mapTransform)),p.alphaMap&&(m.alphaMap.value=p.alphaMap,t(p.alphaMap,m.alphaMapTransform)),p.alphaTest>0&&(m.alphaTest.value=p.alphaTest)}function f(m,p){m.specular.value.copy(p.specular),m.shininess.value=Math.max(p.shininess,1e-4)}function d(m,p){p.gradientMap&&(m.gradientMap.value=p.gradientMap)}function u(m,p){m.metalness.value=p.metalness,p.metalnessMap&&(m.metalnessMap.value=p.metalnessMap,t(p.metalnessMap,m.metalnessMapTransform)),m.roughness.value=p.roughness,p.roughnessMap&&(m.roughnessMap.value=p.roughnessMap,t(p.roughnessMap,m.roughnessMapTransform)),p.envMap&&(m.envMapIntensity.value=p.envMapIntensity)}function h(m,p,v){m.ior.value=p.ior,p.diffuseRoughness>0&&(m.diffuseRoughness.value=p.diffuseRoughness,p.diffuseRoughnessMap&&(m.diffuseRoughnessMap.value=p.diffuseRoughnessMap,t(p.diffuseRoughnessMap,m.diffuseRoughnessMapTransform))),p.sheen>0&&(m.sheenColor.value.copy(p.sheenColor).multiplyScalar(p.sheen),m.sheenRoughness.value=p.sheenRoughness,p.sheenColorMap&&(m.sheenColorMap.value=p.sheenColorMap,t(p.sheenColorMap,m.sheenColorMapTransform)),p.sheenRoughnessMap&&(m.sheenRoughnessMap.value=p.sheenRoughnessMap,t(p.sheenRoughnessMap,m.sheenRoughnessMapTransform))),p.clearcoat>0&&(m.clearcoat.value=p.clearcoat,m.clearcoatRoughness.value=p.clearcoatRoughness,p.clearcoatMap&&(m.clearcoatMap.value=p.clearcoatMap,t(p.clearcoatMap,m.clearcoatMapTransform)),p.clearcoatRoughnessMap&&(m.clearcoatRoughnessMap.value=p.clearcoatRoughnessMap,t(p.clearcoatRoughnessMap,m.clearcoatRoughnessMapTransform)),p.clearcoatNormalMap&&(m.clearcoatNormalMap.value=p.clearcoatNormalMap,t(p.clearcoatNormalMap,m.clearcoatNormalMapTransform),m.clearcoatNormalScale.value.copy(p.clearcoatNormalScale),p.side===en&&m.clearcoatNormalScale.value.negate())),p.dispersion>0&&(m.dispersion.value=p.dispersion),p.retroreflectivity>0&&(m.retroreflectivity.value=p.retroreflectivity),p.iridescence>0&&(m.iridescence.value=p.iridescence,m.iridescenceIOR.value=p.iridescenceIOR,m.iridescenceThicknessMinimum.value=p.iridescenceThicknessMinimum,m.iridescenceThicknessMaximum.value=p.iridescenceThicknessMaximum,p.iridescenceMap&&(m.iridescenceMap.value=p.iridescenceMap,t(p.iridescenceMap,m.iridescenceMapTransform)),p.iridescenceThicknessMap&&(m.iridescenceThicknessMap.value=p.iridescenceThicknessMap,t(p.iridescenceThicknessMap,m.iridescenceThicknessMapTransform))),p.transmission>0&&(m.transmission.value=p.transmission,m.transmissionSamplerMap.value=v.texture,m.transmissionSamplerSize.value.set(v.width,v.height),p.transmissionMap&&(m.transmissionMap.value=p.transmissionMap,t(p.transmissionMap,m.transmissionMapTransform)),m.thickness.value=p.thickness,p.thicknessMap&&(m.thicknessMap.value=p.thicknessMap,t(p.thicknessMap,m.thicknessMapTransform)),m.attenuationDistance.value=p.attenuationDistance,m.attenuationColor.value.copy(p.attenuationColor)),p.anisotropy>0&&(m.anisotropyVector.value.set(p.anisotropy*Math.cos(p.anisotropyRotation),p.anisotropy*Math.sin(p.anisotropyRotation)),p.anisotropyMap&&(m.anisotropyMap.value=p.anisotropyMap,t(p.anisotropyMap,m.anisotropyMapTransform))),m.specularIntensity.value=p.specularIntensity,m.specularColor.value.copy(p.specularColor),p.specularColorMap&&(m.specularColorMap.value=p.specularColorMap,t(p.specularColorMap,m.specularColorMapTransform)),p.specularIntensityMap&&(m.specularIntensityMap.value=p.specularIntensityMap,t(p.specularIntensityMap,m.specularIntensityMapTransform))}function g(m,p){p.matcap&&(m.matcap.value=p.matcap)}function x(m,p){const v=e.get(p).light;m.referencePosition.value.setFromMatrixPosition(v.matrixWorld),m.nearDistance.value=v.shadow.camera.near,m.farDistance.value=v.shadow.camera.far}return{refreshFogUniforms:i,refreshMaterialUniforms:r}}function rM(n,e,t,i){let r={},s={};function a(v,y){const S=y.program;i.uniformBlockBinding(v,S,r[v.id])}function o(v,y){let S=r[v.id];S===void 0&&(g(v),S=l(v),r[v.id]=S,v.addEventListener("dispose",m));const E=y.program;i.updateUBOMapping(v,E);const A=e.render.frame;s[v.id]!==A&&(c(v),s[v.id]=A)}function l(v){const y=n.createBuffer(),S=v.__size,E=v.usage;return n.bindBuffer(n.UNIFORM_BUFFER,y),n.bufferData(n.UNIFORM_BUFFER,S,E),n.bindBuffer(n.UNIFORM_BUFFER,null),y}function c(v){const y=r[v.id],S=v.uniforms,E=v.__cache;n.bindBuffer(n.UNIFORM_BUFFER,y);for(let A=0,_=S.length;A<_;A++){const b=S[A];if(Array.isArray(b))for(let I=0,R=b.length;I<R;I++)f(b[I],A,I,E);else f(b,A,0,E)}n.bindBuffer(n.UNIFORM_BUFFER,null)}function f(v,y,S,E){if(u(v,y,S,E)===!0){const A=v.__offset,_=v.value;if(Array.isArray(_)){let b=0;for(let I=0;I<_.length;I++){const R=_[I],P=x(R,!0);d(R,v.__data,b),b+=P.storage/Float32Array.BYTES_PER_ELEMENT}}else d(_,v.__data,0);n.bufferSubData(n.UNIFORM_BUFFER,A,v.__data)}}function d(v,y,S){typeof v=="number"||typeof v=="boolean"?y[S]=v:v.isMatrix3?(y[S]=v.elements[0],y[S+1]=v.elements[1],y[S+2]=v.elements[2],y[S+3]=0,y[S+4]=v.elements[3],y[S+5]=v.elements[4],y[S+6]=v.elements[5],y[S+7]=0,y[S+8]=v.elements[6],y[S+9]=v.elements[7],y[S+10]=v.elements[8],y[S+11]=0):ArrayBuffer.isView(v)?y.set(v.subarray(0,y.length-S),S):v.toArray(y,S)}function u(v,y,S,E){const A=v.value,_=y+"_"+S;if(Array.isArray(A)){E[_]===void 0&&(E[_]=[]);const b=E[_];let I=!1;for(let R=0;R<A.length;R++)h(A[R],b,R)===!0&&(I=!0);return I}return h(A,E,_)}function h(v,y,S){if(y[S]===void 0)return typeof v=="number"||typeof v=="boolean"?y[S]=v:ArrayBuffer.isView(v)?y[S]=v.slice():y[S]=v.clone(),!0;{const E=y[S];if(typeof v=="number"||typeof v=="boolean"){if(E!==v)return y[S]=v,!0}else{if(ArrayBuffer.isView(v))return!0;if(E.equals(v)===!1)return E.copy(v),!0}}return!1}function g(v){const y=v.uniforms;let S=0;const E=16;for(let _=0,b=y.length;_<b;_++){const I=Array.isArray(y[_])?y[_]:[y[_]];for(let R=0,P=I.length;R<P;R++){const D=I[R],O=Array.isArray(D.value)?D.value:[D.value],L=Array.isArray(y[_])||Array.isArray(D.value);let k=S;for(let W=0,te=O.length;W<te;W++){const X=O[W],j=x(X,L),ee=S%E,Se=ee%j.boundary,De=ee+Se;S+=Se,De!==0&&E-De<j.storage&&(S+=E-De),W===0&&(k=S),S+=j.storage}const V=D.type==="int"?Int32Array:D.type==="uint"?Uint32Array:Float32Array;D.__data=new V((S-k)/Float32Array.BYTES_PER_ELEMENT),D.__offset=k}}const A=S%E;return A>0&&(S+=E-A),v.__size=S,v.__cache={},this}function x(v,y){const S={boundary:0,storage:0};return typeof v=="number"||typeof v=="boolean"?(S.boundary=4,S.storage=4):v.isVector2?(S.boundary=8,S.storage=8):v.isVector3||v.isColor?(S.boundary=16,S.storage=12):v.isVector4?(S.boundary=16,S.storage=16):v.isMatrix3?(S.boundary=16,S.storage=48):v.isMatrix4?(S.boundary=16,S.storage=64):v.isTexture?Le("WebGLRenderer: Texture samplers can not be part of an uniforms group."):ArrayBuffer.isView(v)?(S.boundary=16,S.storage=v.byteLength):Le("WebGLRenderer: Unsupported uniform value type.",v),y===!0&&(S.boundary=16,S.storage=Math.ceil(S.storage/16)*16),S}function m(v){const y=v.target;y.removeEventListener("dispose",m),n.deleteBuffer(r[y.id]),delete r[y.id],delete s[y.id]}function p(){for(const v in r)n.deleteBuffer(r[v]);r={},s={}}return{bind:a,update:o,dispose:p}}const sM=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]);let Zn=null;function aM(){return Zn===null&&(Zn=new I_(sM,16,16,hr,Wn),Zn.name="DFG_LUT",Zn.minFilter=on,Zn.magFilter=on,Zn.wrapS=mi,Zn.wrapT=mi,Zn.generateMipmaps=!1,Zn.needsUpdate=!0),Zn}class Kh{constructor(e={}){const{canvas:t=s_(),context:i=null,depth:r=!0,stencil:s=!1,alpha:a=!1,antialias:o=!1,premultipliedAlpha:l=!0,preserveDrawingBuffer:c=!1,powerPreference:f="default",failIfMajorPerformanceCaveat:d=!1,reversedDepthBuffer:u=!1,outputBufferType:h=xn}=e;this.isWebGLRenderer=!0;let g;if(i!==null){if(typeof WebGLRenderingContext<"u"&&i instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");g=i.getContextAttributes().alpha}else g=a;const x=h,m=new Set([ec,jl,Ql]),p=new Set([xn,Gn,Gs,Wr,Zl,Jl]),v=new Uint32Array(4),y=new Int32Array(4),S={textures:[],min:[],max:[],resolution:[]};let E=null,A=null;const _=[],b=[];let I=null;this.domElement=t,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=pi,this.toneMappingExposure=1,this.transmissionResolutionScale=1;const R=this;let P=!1,D=null,O=null,L=null,k=null;this._outputColorSpace=Sn;let V=0,W=0,te=null,X=-1,j=null;const ee=new ot,Se=new ot;let De=null;const Z=new Je(0);let fe=0,xe=t.width,Ae=t.height,ge=1,Ie=null,_t=null;const Re=new ot(0,0,xe,Ae),Ke=new ot(0,0,xe,Ae);let st=!1;const $e=new ho,Gt=new ru;let Lt=!1,cn=!1;const pt=new tt,ai=new N,Ut=new ot,An={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0};let Rn=!1;function Cn(){return te===null?ge:1}let B=i;function Pn(T,F){return t.getContext(T,F)}let ft,dt,pe,Dt,Ce,Ne,C,w,H,ne,Q,ae,de,Y,K,le,U,J,q,ce,se,oe,we;try{const T={alpha:!0,depth:r,stencil:s,antialias:o,premultipliedAlpha:l,preserveDrawingBuffer:c,powerPreference:f,failIfMajorPerformanceCaveat:d};if("setAttribute"in t&&t.setAttribute("data-engine",`three.js r${Os}`),t.addEventListener("webglcontextlost",Te,!1),t.addEventListener("webglcontextrestored",ke,!1),t.addEventListener("webglcontextcreationerror",_e,!1),B===null){const F="webgl2";if(B=Pn(F,T),B===null)throw Pn(F)?new Error("THREE.WebGLRenderer: Error creating WebGL context with your selected attributes."):new Error("THREE.WebGLRenderer: Error creating WebGL context.")}Ge()}catch(T){throw t.removeEventListener("webglcontextlost",Te,!1),t.removeEventListener("webglcontextrestored",ke,!1),t.removeEventListener("webglcontextcreationerror",_e,!1),Qe("WebGLRenderer: "+T.message),T}function Ge(){ft=new ux(B),ft.init(),se=new JS(B,ft),dt=new jv(B,ft,e,se),pe=new KS(B,ft),dt.reversedDepthBuffer&&u&&pe.buffers.depth.setReversed(!0),O=B.createFramebuffer(),L=B.createFramebuffer(),k=B.createFramebuffer(),Dt=new hx(B),Ce=new US,Ne=new ZS(B,ft,pe,Ce,dt,se,Dt),C=new cx(R),w=new K_(B),oe=new Jv(B,w),H=new fx(B,w,Dt,oe),ne=new mx(B,H,w,oe,Dt),J=new px(B,dt,Ne),K=new ex(Ce),Q=new NS(R,C,ft,dt,oe,K),ae=new iM(R,Ce),de=new OS,Y=new VS(ft),U=new Zv(R,C,pe,ne,g,l),le=new YS(R,ne,dt),we=new rM(B,Dt,dt,pe),q=new Qv(B,ft,Dt),ce=new dx(B,ft,Dt),Dt.programs=Q.programs,R.capabilities=dt,R.extensions=ft,R.properties=Ce,R.renderLists=de,R.shadowMap=le,R.state=pe,R.info=Dt}x!==xn&&(I=new _x(x,t.width,t.height,o,r,s));const ie=new tM(R,B);this.xr=ie,this.getContext=function(){return B},this.getContextAttributes=function(){return B.getContextAttributes()},this.forceContextLoss=function(){const T=ft.get("WEBGL_lose_context");T&&T.loseContext()},this.forceContextRestore=function(){const T=ft.get("WEBGL_lose_context");T&&T.restoreContext()},this.getPixelRatio=function(){return ge},this.setPixelRatio=function(T){T!==void 0&&(ge=T,this.setSize(xe,Ae,!1))},this.getSize=function(T){return T.set(xe,Ae)},this.setSize=function(T,F,$=!0){if(ie.isPresenting){Le("WebGLRenderer: Can't change size while VR device is presenting.");return}xe=T,Ae=F,t.width=Math.floor(T*ge),t.height=Math.floor(F*ge),$===!0&&(t.style.width=T+"px",t.style.height=F+"px"),I!==null&&I.setSize(t.width,t.height),this.setViewport(0,0,T,F)},this.getDrawingBufferSize=function(T){return T.set(xe*ge,Ae*ge).floor()},this.setDrawingBufferSize=function(T,F,$){xe=T,Ae=F,ge=$,t.width=Math.floor(T*$),t.height=Math.floor(F*$),this.setViewport(0,0,T,F)},this.setEffects=function(T){if(x===xn){Qe("WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.");return}if(T){for(let F=0;F<T.length;F++)if(T[F].isOutputPass===!0){Le("WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.");break}}I.setEffects(T||[])},this.getCurrentViewport=function(T){return T.copy(ee)},this.getViewport=function(T){return T.copy(Re)},this.setViewport=function(T,F,$,z){T.isVector4?Re.set(T.x,T.y,T.z,T.w):Re.set(T,F,$,z),pe.viewport(ee.copy(Re).multiplyScalar(Cn()).round())},this.getScissor=function(T){return T.copy(Ke)},this.setScissor=function(T,F,$,z){T.isVector4?Ke.set(T.x,T.y,T.z,T.w):Ke.set(T,F,$,z),pe.scissor(Se.copy(Ke).multiplyScalar(Cn()).round())},this.getScissorTest=function(){return st},this.setScissorTest=function(T){pe.setScissorTest(st=T)},this.setOpaqueSort=function(T){Ie=T},this.setTransparentSort=function(T){_t=T},this.getClearColor=function(T){return T.copy(U.getClearColor())},this.setClearColor=function(){U.setClearColor(...arguments)},this.getClearAlpha=function(){return U.getClearAlpha()},this.setClearAlpha=function(){U.setClearAlpha(...arguments)},this.clear=function(T=!0,F=!0,$=!0){let z=0;if(T){let G=!1;if(te!==null){const he=te.texture.format;G=m.has(he)}if(G){const he=te.texture.type,Me=p.has(he),ue=U.getClearColor(),ve=U.getClearAlpha(),Ee=ue.r,Ue=ue.g,Xe=ue.b;Me?(v[0]=Ee,v[1]=Ue,v[2]=Xe,v[3]=ve,B.clearBufferuiv(B.COLOR,0,v)):(y[0]=Ee,y[1]=Ue,y[2]=Xe,y[3]=ve,B.clearBufferiv(B.COLOR,0,y))}else z|=B.COLOR_BUFFER_BIT}F&&(z|=B.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),$&&(z|=B.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),z!==0&&B.clear(z)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(T){T.setRenderer(this),D=T},this.dispose=function(){t.removeEventListener("webglcontextlost",Te,!1),t.removeEventListener("webglcontextrestored",ke,!1),t.removeEventListener("webglcontextcreationerror",_e,!1),U.dispose(),de.dispose(),Y.dispose(),Ne.dispose(),Ce.dispose(),C.dispose(),ne.dispose(),H.dispose(),oe.dispose(),we.dispose(),Q.dispose(),ie.dispose(),ie.removeEventListener("sessionstart",om),ie.removeEventListener("sessionend",lm),Dr.stop()};function Te(T){T.preventDefault(),Id("WebGLRenderer: Context Lost."),P=!0}function ke(){Id("WebGLRenderer: Context Restored."),P=!1;const T=Dt.autoReset,F=le.enabled,$=le.autoUpdate,z=le.needsUpdate,G=le.type;Ge(),Dt.autoReset=T,le.enabled=F,le.autoUpdate=$,le.needsUpdate=z,le.type=G}function _e(T){Qe("WebGLRenderer: A WebGL context could not be created. Reason: ",T.statusMessage)}function rt(T){const F=T.target;F.removeEventListener("dispose",rt),Ft(F)}function Ft(T){rr(T),Ce.remove(T)}function rr(T){const F=Ce.get(T).programs;F!==void 0&&(F.forEach(function($){Q.releaseProgram($)}),T.isShaderMaterial&&Q.releaseShaderCache(T))}this.renderBufferDirect=function(T,F,$,z,G,he){F===null&&(F=An);const Me=G.isMesh&&G.matrixWorld.determinantAffine()<0,ue=oE(T,F,$,z,G);pe.setMaterial(z,Me);let ve=$.index,Ee=1;if(z.wireframe===!0){if(ve=H.getWireframeAttribute($),ve===void 0)return;Ee=2}const Ue=$.drawRange,Xe=$.attributes.position;let ye=Ue.start*Ee,qe=(Ue.start+Ue.count)*Ee;he!==null&&(ye=Math.max(ye,he.start*Ee),qe=Math.min(qe,(he.start+he.count)*Ee)),ve!==null?(ye=Math.max(ye,0),qe=Math.min(qe,ve.count)):Xe!=null&&(ye=Math.max(ye,0),qe=Math.min(qe,Xe.count));const Et=qe-ye;if(Et<0||Et===1/0)return;oe.setup(G,z,ue,$,ve);let ct,at=q;if(ve!==null&&(ct=w.get(ve),at=ce,at.setIndex(ct)),G.isMesh)z.wireframe===!0?(pe.setLineWidth(z.wireframeLinewidth*Cn()),at.setMode(B.LINES)):at.setMode(B.TRIANGLES);else if(G.isLine){let Zt=z.linewidth;Zt===void 0&&(Zt=1),pe.setLineWidth(Zt*Cn()),G.isLineSegments?at.setMode(B.LINES):G.isLineLoop?at.setMode(B.LINE_LOOP):at.setMode(B.LINE_STRIP)}else G.isPoints?at.setMode(B.POINTS):G.isSprite&&at.setMode(B.TRIANGLES);if(G.isBatchedMesh)if(ft.get("WEBGL_multi_draw"))at.renderMultiDraw(G._multiDrawStarts,G._multiDrawCounts,G._multiDrawCount);else{const Zt=G._multiDrawStarts,be=G._multiDrawCounts,an=G._multiDrawCount,je=ve?w.get(ve).bytesPerElement:1,Ir=Ce.get(z).currentProgram.getUniforms();for(let Jt=0;Jt<an;Jt++)Ir.setValue(B,"_gl_DrawID",Jt),at.render(Zt[Jt]/je,be[Jt])}else if(G.isInstancedMesh)at.renderInstances(ye,Et,G.count);else if($.isInstancedBufferGeometry){const Zt=$._maxInstanceCount!==void 0?$._maxInstanceCount:1/0,be=Math.min($.instanceCount,Zt);at.renderInstances(ye,Et,be)}else at.render(ye,Et)};function am(T,F,$,z){D!==null&&T.isNodeMaterial&&D.setObject(z,T),Lt===!0&&K.setState(T,$,!1),T.transparent===!0&&T.side===un&&T.forceSinglePass===!1?(T.side=en,T.needsUpdate=!0,pa(T,F,z),T.side=hi,T.needsUpdate=!0,pa(T,F,z),T.side=un):pa(T,F,z)}this.compile=function(T,F,$=null){$===null&&($=T),D!==null&&D.renderStart(T,F,$),A=Y.get($),A.init(F),b.push(A),$.traverseVisible(function(G){G.isLight&&G.layers.test(F.layers)&&(A.pushLight(G),G.castShadow&&A.pushShadow(G))}),T!==$&&T.traverseVisible(function(G){G.isLight&&G.layers.test(F.layers)&&(A.pushLight(G),G.castShadow&&A.pushShadow(G))}),A.setupLights(),D!==null&&D.updateLights(A.state.lightsArray),cn=this.localClippingEnabled,Lt=K.init(this.clippingPlanes,cn),Lt===!0&&K.setGlobalState(this.clippingPlanes,F),D!==null&&le.render(A.state.shadowsArray,$,F);const z=new Set;return T.traverse(function(G){if(!(G.isMesh||G.isPoints||G.isLine||G.isSprite))return;const he=G.material;if(he)if(Array.isArray(he))for(let Me=0;Me<he.length;Me++){const ue=he[Me];am(ue,$,F,G),z.add(ue)}else am(he,$,F,G),z.add(he)}),A=b.pop(),D!==null&&D.renderEnd(),z},this.compileAsync=function(T,F,$=null){const z=this.compile(T,F,$);return new Promise(G=>{function he(){if(z.forEach(function(Me){const ve=Ce.get(Me).currentProgram;(ve===void 0||ve.isReady())&&z.delete(Me)}),z.size===0){G(T);return}setTimeout(he,10)}ft.get("KHR_parallel_shader_compile")!==null?he():setTimeout(he,10)})};let af=null;function sE(T){af&&af(T)}function om(){Dr.stop()}function lm(){Dr.start()}const Dr=new _h;Dr.setAnimationLoop(sE),typeof self<"u"&&Dr.setContext(self),this.setAnimationLoop=function(T){af=T,ie.setAnimationLoop(T),T===null?Dr.stop():Dr.start()},ie.addEventListener("sessionstart",om),ie.addEventListener("sessionend",lm),this.render=function(T,F){if(F!==void 0&&F.isCamera!==!0){Qe("WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(P===!0)return;D!==null&&D.renderStart(T,F);const $=ie.enabled===!0&&ie.isPresenting===!0,z=I!==null&&(te===null||$)&&I.begin(R,te);if(T.matrixWorldAutoUpdate===!0&&T.updateMatrixWorld(),F.parent===null&&F.matrixWorldAutoUpdate===!0&&F.updateMatrixWorld(),ie.enabled===!0&&ie.isPresenting===!0&&(I===null||I.isCompositing()===!1)&&(ie.cameraAutoUpdate===!0&&ie.updateCamera(F),F=ie.getCamera()),T.isScene===!0&&T.onBeforeRender(R,T,F,te),A=Y.get(T,b.length),A.init(F),A.state.textureUnits=Ne.getTextureUnits(),b.push(A),pt.multiplyMatrices(F.projectionMatrix,F.matrixWorldInverse),F.isArrayCamera?Gt.setFromArrayCamera(F):$e.setFromProjectionMatrix(pt,Ln,F.reversedDepth),cn=this.localClippingEnabled,Lt=K.init(this.clippingPlanes,cn),E=de.get(T,_.length),E.init(),_.push(E),this.info.render.frame++,ie.enabled===!0&&ie.isPresenting===!0){const Me=R.xr.getDepthSensingMesh();Me!==null&&of(Me,F,-1/0,R.sortObjects)}of(T,F,0,R.sortObjects),E.finish(),D!==null&&D.updateLights(A.state.lightsArray),R.sortObjects===!0&&E.sort(Ie,_t),Rn=ie.enabled===!1||ie.isPresenting===!1||ie.hasDepthSensing()===!1,Rn&&U.addToRenderList(E,T),this.info.autoReset===!0&&this.info.reset(),Lt===!0&&K.beginShadows();const G=A.state.shadowsArray;if(le.render(G,T,F),Lt===!0&&K.endShadows(),(z&&I.hasRenderPass())===!1){const Me=E.opaque,ue=E.transmissive;if(A.setupLights(),F.isArrayCamera){const ve=F.cameras;if(ue.length>0)for(let Ee=0,Ue=ve.length;Ee<Ue;Ee++){const Xe=ve[Ee];um(Me,ue,T,Xe)}Rn&&U.render(T);for(let Ee=0,Ue=ve.length;Ee<Ue;Ee++){const Xe=ve[Ee];cm(E,T,Xe,Xe.viewport)}}else ue.length>0&&um(Me,ue,T,F),Rn&&U.render(T),cm(E,T,F)}te!==null&&W===0&&(Ne.updateMultisampleRenderTarget(te),Ne.updateRenderTargetMipmap(te)),z&&I.end(R),T.isScene===!0&&T.onAfterRender(R,T,F),oe.resetDefaultState(),X=-1,j=null,b.pop(),b.length>0?(A=b[b.length-1],Ne.setTextureUnits(A.state.textureUnits),Lt===!0&&K.setGlobalState(R.clippingPlanes,A.state.camera)):A=null,_.pop(),_.length>0?E=_[_.length-1]:E=null,D!==null&&D.renderEnd()};function of(T,F,$,z){if(T.visible===!1)return;if(T.layers.test(F.layers)){if(T.isGroup)$=T.renderOrder;else if(T.isLOD)T.autoUpdate===!0&&T.update(F);else if(T.isLight)A.pushLight(T),T.castShadow&&A.pushShadow(T);else if(T.isSprite){const Me=F.isArrayCamera?Gt:$e;if(!T.frustumCulled||T.intersectsFrustum(Me)){z&&Ut.setFromMatrixPosition(T.matrixWorld).applyMatrix4(pt);const ue=ne.update(T),ve=T.material;ve.visible&&E.push(T,ue,ve,$,Ut.z,null,F)}}else if(T.isMesh||T.isLine||T.isPoints){const Me=F.isArrayCamera?Gt:$e;if(!T.frustumCulled||T.intersectsFrustum(Me)){const ue=ne.update(T),ve=T.material;if(z&&(T.boundingSphere!==void 0?(T.boundingSphere===null&&T.computeBoundingSphere(),Ut.copy(T.boundingSphere.center)):(ue.boundingSphere===null&&ue.computeBoundingSphere(),Ut.copy(ue.boundingSphere.center)),Ut.applyMatrix4(T.matrixWorld).applyMatrix4(pt)),Array.isArray(ve)){const Ee=ue.groups;for(let Ue=0,Xe=Ee.length;Ue<Xe;Ue++){const ye=Ee[Ue],qe=ve[ye.materialIndex];qe&&qe.visible&&E.push(T,ue,qe,$,Ut.z,ye,F)}}else ve.visible&&E.push(T,ue,ve,$,Ut.z,null,F)}}}const he=T.children;for(let Me=0,ue=he.length;Me<ue;Me++)of(he[Me],F,$,z)}function cm(T,F,$,z){const{opaque:G,transmissive:he,transparent:Me}=T;A.setupLightsView($),Lt===!0&&K.setGlobalState(R.clippingPlanes,$),z&&pe.viewport(ee.copy(z)),G.length>0&&ul(G,F,$),he.length>0&&ul(he,F,$),Me.length>0&&ul(Me,F,$),pe.buffers.depth.setTest(!0),pe.buffers.depth.setMask(!0),pe.buffers.color.setMask(!0),pe.setPolygonOffset(!1)}function um(T,F,$,z){if(($.isScene===!0?$.overrideMaterial:null)!==null)return;if(A.state.transmissionRenderTarget[z.id]===void 0){const ye=ft.has("EXT_color_buffer_half_float")||ft.has("EXT_color_buffer_float");A.state.transmissionRenderTarget[z.id]=new Dn(1,1,{generateMipmaps:!0,type:ye?Wn:xn,minFilter:Ui,samples:Math.max(4,dt.samples),stencilBuffer:s,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:Ye.workingColorSpace})}const he=A.state.transmissionRenderTarget[z.id],Me=z.viewport||ee;he.setSize(Me.z*R.transmissionResolutionScale,Me.w*R.transmissionResolutionScale);const ue=R.getRenderTarget(),ve=R.getActiveCubeFace(),Ee=R.getActiveMipmapLevel();R.setRenderTarget(he),R.getClearColor(Z),fe=R.getClearAlpha(),fe<1&&R.setClearColor(16777215,.5),R.clear(),Rn&&U.render($);const Ue=R.toneMapping;R.toneMapping=pi;const Xe=z.viewport;if(z.viewport!==void 0&&(z.viewport=void 0),A.setupLightsView(z),Lt===!0&&K.setGlobalState(R.clippingPlanes,z),ul(T,$,z),Ne.updateMultisampleRenderTarget(he),Ne.updateRenderTargetMipmap(he),ft.has("WEBGL_multisampled_render_to_texture")===!1){let ye=!1;for(let qe=0,Et=F.length;qe<Et;qe++){const ct=F[qe],{object:at,geometry:Zt,material:be,group:an}=ct;if(be.side===un&&at.layers.test(z.layers)){const je=be.side;be.side=en,be.needsUpdate=!0,fm(at,$,z,Zt,be,an),be.side=je,be.needsUpdate=!0,ye=!0}}ye===!0&&(Ne.updateMultisampleRenderTarget(he),Ne.updateRenderTargetMipmap(he))}R.setRenderTarget(ue,ve,Ee),R.setClearColor(Z,fe),Xe!==void 0&&(z.viewport=Xe),R.toneMapping=Ue}function ul(T,F,$){const z=F.isScene===!0?F.overrideMaterial:null;for(let G=0,he=T.length;G<he;G++){const Me=T[G],{object:ue,geometry:ve,group:Ee}=Me;let Ue=Me.material;Ue.allowOverride===!0&&z!==null&&(Ue=z),ue.layers.test($.layers)&&fm(ue,F,$,ve,Ue,Ee)}}function fm(T,F,$,z,G,he){D!==null&&G.isNodeMaterial&&D.setObject(T,G),T.onBeforeRender(R,F,$,z,G,he),T.modelViewMatrix.multiplyMatrices($.matrixWorldInverse,T.matrixWorld),T.normalMatrix.getNormalMatrix(T.modelViewMatrix),G.onBeforeRender(R,F,$,z,T,he),G.transparent===!0&&G.side===un&&G.forceSinglePass===!1?(G.side=en,G.needsUpdate=!0,R.renderBufferDirect($,F,z,G,T,he),G.side=hi,G.needsUpdate=!0,R.renderBufferDirect($,F,z,G,T,he),G.side=un):R.renderBufferDirect($,F,z,G,T,he),T.onAfterRender(R,F,$,z,G,he)}function dm(T){let F=0;for(const $ of T)$.texture!==null&&F++;return F}function pa(T,F,$){F.isScene!==!0&&(F=An);const z=Ce.get(T),G=A.state.lights,he=A.state.shadowsArray,Me=G.state.version,ue=Q.getParameters(T,G.state,he,F,$,A.state.lightProbeGridArray),ve=Q.getProgramCacheKey(ue);let Ee=z.programs;z.environment=T.isMeshStandardMaterial||T.isMeshLambertMaterial||T.isMeshPhongMaterial?F.environment:null,z.fog=F.fog;const Ue=T.isMeshStandardMaterial||T.isMeshLambertMaterial&&!T.envMap||T.isMeshPhongMaterial&&!T.envMap;z.envMap=C.get(T.envMap||z.environment,Ue),z.envMapRotation=z.environment!==null&&T.envMap===null?F.environmentRotation:T.envMapRotation,Ee===void 0&&(T.addEventListener("dispose",rt),Ee=new Map,z.programs=Ee,z.programVariants=new Map);let Xe=Ee.get(ve);if(Xe!==void 0){if(z.currentProgram===Xe&&z.lightsStateVersion===Me)return pm(T,ue),Xe}else ue.uniforms=Q.getUniforms(T),D!==null&&T.isNodeMaterial&&D.build(T,$,ue),T.onBeforeCompile(ue,R),Xe=Q.acquireProgram(ue,ve),Ee.set(ve,Xe),z.uniforms=ue.uniforms;const ye=z.uniforms;return(!T.isShaderMaterial&&!T.isRawShaderMaterial||T.clipping===!0)&&(ye.clippingPlanes=K.uniform),pm(T,ue),z.needsLights=cE(T),z.lightsStateVersion=Me,z.needsLights&&(ye.ambientLightColor.value=G.state.ambient,ye.lightProbe.value=G.state.probe,ye.sunLights.value=G.state.sun,ye.sunLightShadows.value=G.state.sunShadow,ye.directionalLights.value=G.state.directional,ye.directionalLightShadows.value=G.state.directionalShadow,ye.spotLights.value=G.state.spot,ye.spotLightShadows.value=G.state.spotShadow,ye.rectAreaLights.value=G.state.rectArea,ye.ltc_1.value=G.state.rectAreaLTC1,ye.ltc_2.value=G.state.rectAreaLTC2,ye.pointLights.value=G.state.point,ye.pointLightShadows.value=G.state.pointShadow,ye.hemisphereLights.value=G.state.hemi,ye.sunShadowMatrix.value=G.state.sunShadowMatrix,ye.sunShadowCascade.value=G.state.sunShadowCascade,ye.directionalShadowMatrix.value=G.state.directionalShadowMatrix,ye.spotLightMatrix.value=G.state.spotLightMatrix,ye.spotLightMap.value=G.state.spotLightMap,ye.pointShadowMatrix.value=G.state.pointShadowMatrix),z.numLightProbeGrids=dm(A.state.lightProbeGridArray),z.currentProgram=Xe,z.uniformsList=null,Xe}function aE(T,F,$,z,G){const he=Ce.get(T),Me=he.currentProgram.id+","+z+","+G;let ue=he.programVariants.get(Me);return ue===void 0?(ue=pa(T,F,$),he.programVariants.set(Me,ue)):(he.currentProgram=ue,he.uniformsList=null,he.outputColorSpace=z,he.toneMapping=G),ue}function hm(T){if(T.uniformsList===null){const F=T.currentProgram.getUniforms();T.uniformsList=To.seqWithValue(F.seq,T.uniforms)}return T.uniformsList}function pm(T,F){const $=Ce.get(T);$.outputColorSpace=F.outputColorSpace,$.batching=F.batching,$.batchingColor=F.batchingColor,$.instancing=F.instancing,$.instancingColor=F.instancingColor,$.instancingMorph=F.instancingMorph,$.skinning=F.skinning,$.morphTargets=F.morphTargets,$.morphNormals=F.morphNormals,$.morphColors=F.morphColors,$.morphTargetsCount=F.morphTargetsCount,$.numClippingPlanes=F.numClippingPlanes,$.numIntersection=F.numClipIntersection,$.vertexAlphas=F.vertexAlphas,$.vertexTangents=F.vertexTangents,$.toneMapping=F.toneMapping}function oE(T,F,$,z,G){F.isScene!==!0&&(F=An),Ne.resetTextureUnits();const he=F.fog,Me=z.isMeshStandardMaterial||z.isMeshLambertMaterial||z.isMeshPhongMaterial?F.environment:null,ue=te===null?R.outputColorSpace:te.isXRRenderTarget===!0?te.texture.colorSpace:Ye.workingColorSpace,ve=z.isMeshStandardMaterial||z.isMeshLambertMaterial&&!z.envMap||z.isMeshPhongMaterial&&!z.envMap,Ee=C.get(z.envMap||Me,ve),Ue=z.vertexColors===!0&&!!$.attributes.color&&$.attributes.color.itemSize===4,Xe=!!$.attributes.tangent&&(!!z.normalMap||z.anisotropy>0),ye=!!$.morphAttributes.position,qe=!!$.morphAttributes.normal,Et=!!$.morphAttributes.color;let ct=pi;z.toneMapped&&(te===null||te.isXRRenderTarget===!0)&&(ct=R.toneMapping);const at=$.morphAttributes.position||$.morphAttributes.normal||$.morphAttributes.color,Zt=at!==void 0?at.length:0,be=Ce.get(z),an=A.state.lights;if(Lt===!0&&(cn===!0||T!==j)){const mt=T===j&&z.id===X;K.setState(z,T,mt)}let je=!1,Ir=!1;z.version===be.__version?be.needsLights&&be.lightsStateVersion!==an.state.version||G.isBatchedMesh&&be.batching===!1||!G.isBatchedMesh&&be.batching===!0||G.isBatchedMesh&&be.batchingColor===!0&&G._colorsTexture===null||G.isBatchedMesh&&be.batchingColor===!1&&G._colorsTexture!==null||G.isInstancedMesh&&be.instancing===!1||!G.isInstancedMesh&&be.instancing===!0||G.isSkinnedMesh&&be.skinning===!1||!G.isSkinnedMesh&&be.skinning===!0||G.isInstancedMesh&&be.instancingColor===!0&&G.instanceColor===null||G.isInstancedMesh&&be.instancingColor===!1&&G.instanceColor!==null||G.isInstancedMesh&&be.instancingMorph===!0&&G.morphTexture===null||G.isInstancedMesh&&be.instancingMorph===!1&&G.morphTexture!==null||be.envMap!==Ee||z.fog===!0&&be.fog!==he||be.numClippingPlanes!==void 0&&(be.numClippingPlanes!==K.numPlanes||be.numIntersection!==K.numIntersection)||be.vertexAlphas!==Ue||be.vertexTangents!==Xe||be.morphTargets!==ye||be.morphNormals!==qe||be.morphColors!==Et||be.morphTargetsCount!==Zt||be.numLightProbeGrids!==dm(A.state.lightProbeGridArray)?je=!0:(be.outputColorSpace!==ue||be.toneMapping!==ct)&&(Ir=!0):(je=!0,be.__version=z.version);let Jt=be.currentProgram;(je===!0||Ir===!0)&&(Jt=Ir===!0?aE(z,F,G,ue,ct):pa(z,F,G),D&&z.isNodeMaterial&&D.onUpdateProgram(z,Jt,be));let fl=!1,sr=!1,Nr=!1;const Ze=Jt.getUniforms(),Vt=be.uniforms;if(pe.useProgram(Jt.program)&&(fl=!0,sr=!0,Nr=!0),z.id!==X&&(X=z.id,sr=!0),fl||j!==T){pe.buffers.depth.getReversed()&&T.reversedDepth!==!0&&(T._reversedDepth=!0,T.updateProjectionMatrix()),Ze.setValue(B,"projectionMatrix",T.projectionMatrix),Ze.setValue(B,"viewMatrix",T.matrixWorldInverse);const Ot=Ze.map.cameraPosition;Ot!==void 0&&Ot.setValue(B,ai.setFromMatrixPosition(T.matrixWorld)),dt.logarithmicDepthBuffer&&Ze.setValue(B,"logDepthBufFC",2/(Math.log(T.far+1)/Math.LN2)),(z.isMeshPhongMaterial||z.isMeshToonMaterial||z.isMeshLambertMaterial||z.isMeshBasicMaterial||z.isMeshStandardMaterial||z.isShaderMaterial)&&Ze.setValue(B,"isOrthographic",T.isOrthographicCamera===!0),j!==T&&(j=T,sr=!0,Nr=!0)}if(be.needsLights&&(an.state.sunShadowMap.length>0&&Ze.setValue(B,"sunShadowMap",an.state.sunShadowMap,Ne),an.state.directionalShadowMap.length>0&&Ze.setValue(B,"directionalShadowMap",an.state.directionalShadowMap,Ne),an.state.spotShadowMap.length>0&&Ze.setValue(B,"spotShadowMap",an.state.spotShadowMap,Ne),an.state.pointShadowMap.length>0&&Ze.setValue(B,"pointShadowMap",an.state.pointShadowMap,Ne)),G.isSkinnedMesh){Ze.setOptional(B,G,"bindMatrix"),Ze.setOptional(B,G,"bindMatrixInverse");const mt=G.skeleton;mt&&(mt.boneTexture===null&&mt.computeBoneTexture(),Ze.setValue(B,"boneTexture",mt.boneTexture,Ne))}G.isBatchedMesh&&(Ze.setOptional(B,G,"batchingTexture"),Ze.setValue(B,"batchingTexture",G._matricesTexture,Ne),Ze.setOptional(B,G,"batchingIdTexture"),Ze.setValue(B,"batchingIdTexture",G._indirectTexture,Ne),Ze.setOptional(B,G,"batchingColorTexture"),G._colorsTexture!==null&&Ze.setValue(B,"batchingColorTexture",G._colorsTexture,Ne));const zn=$.morphAttributes;if((zn.position!==void 0||zn.normal!==void 0||zn.color!==void 0)&&J.update(G,$,Jt),(sr||be.receiveShadow!==G.receiveShadow)&&(be.receiveShadow=G.receiveShadow,Ze.setValue(B,"receiveShadow",G.receiveShadow)),(z.isMeshStandardMaterial||z.isMeshLambertMaterial||z.isMeshPhongMaterial)&&z.envMap===null&&F.environment!==null&&(Vt.envMapIntensity.value=F.environmentIntensity),Vt.dfgLUT!==void 0&&(Vt.dfgLUT.value=aM()),sr){if(Ze.setValue(B,"toneMappingExposure",R.toneMappingExposure),be.needsLights&&lE(Vt,Nr),he&&z.fog===!0&&ae.refreshFogUniforms(Vt,he),ae.refreshMaterialUniforms(Vt,z,ge,Ae,A.state.transmissionRenderTarget[T.id]),be.needsLights&&be.numLightProbeGrids>0){const mt=S;let Ot=0;for(const Di of A.state.lightProbeGridArray)Di.texture!==null&&(mt.textures[Ot]=Di.texture,mt.min[Ot]=Di.boundingBox.min,mt.max[Ot]=Di.boundingBox.max,mt.resolution[Ot]=Di.resolution,Ot++);for(const Di in mt)mt[Di].length=Ot;Vt.probesSH.value=mt.textures,Vt.probesMin.value=mt.min,Vt.probesMax.value=mt.max,Vt.probesResolution.value=mt.resolution}To.upload(B,hm(be),Vt,Ne)}if(z.isShaderMaterial&&z.uniformsNeedUpdate===!0&&(To.upload(B,hm(be),Vt,Ne),z.uniformsNeedUpdate=!1),z.isSpriteMaterial&&Ze.setValue(B,"center",G.center),Ze.setValue(B,"modelViewMatrix",G.modelViewMatrix),Ze.setValue(B,"normalMatrix",G.normalMatrix),Ze.setValue(B,"modelMatrix",G.matrixWorld),z.uniformsGroups!==void 0){const mt=z.uniformsGroups;for(let Ot=0,Di=mt.length;Ot<Di;Ot++){const gm=mt[Ot];we.update(gm,Jt),we.bind(gm,Jt)}}return Jt}function lE(T,F){T.ambientLightColor.needsUpdate=F,T.lightProbe.needsUpdate=F,T.sunLights.needsUpdate=F,T.sunLightShadows.needsUpdate=F,T.directionalLights.needsUpdate=F,T.directionalLightShadows.needsUpdate=F,T.pointLights.needsUpdate=F,T.pointLightShadows.needsUpdate=F,T.spotLights.needsUpdate=F,T.spotLightShadows.needsUpdate=F,T.rectAreaLights.needsUpdate=F,T.hemisphereLights.needsUpdate=F}function cE(T){return T.isMeshLambertMaterial||T.isMeshToonMaterial||T.isMeshPhongMaterial||T.isMeshStandardMaterial||T.isShadowMaterial||T.isShaderMaterial&&T.lights===!0}this.getActiveCubeFace=function(){return V},this.getActiveMipmapLevel=function(){return W},this.getRenderTarget=function(){return te},this.setRenderTargetTextures=function(T,F,$){const z=Ce.get(T);z.__autoAllocateDepthBuffer=T.resolveDepthBuffer===!1,z.__autoAllocateDepthBuffer===!1&&(z.__useRenderToTexture=!1),Ce.get(T.texture).__webglTexture=F,Ce.get(T.depthTexture).__webglTexture=z.__autoAllocateDepthBuffer?void 0:$,z.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(T,F){const $=Ce.get(T);$.__webglFramebuffer=F,$.__useDefaultFramebuffer=F===void 0},this.setRenderTarget=function(T,F=0,$=0){te=T,V=F,W=$;let z=null,G=!1,he=!1;if(T){const ue=Ce.get(T);if(ue.__useDefaultFramebuffer!==void 0){pe.bindFramebuffer(B.FRAMEBUFFER,ue.__webglFramebuffer),ee.copy(T.viewport),Se.copy(T.scissor),De=T.scissorTest,pe.viewport(ee),pe.scissor(Se),pe.setScissorTest(De),X=-1;return}else if(ue.__webglFramebuffer===void 0)Ne.setupRenderTarget(T);else if(ue.__hasExternalTextures)Ne.rebindTextures(T,Ce.get(T.texture).__webglTexture,Ce.get(T.depthTexture).__webglTexture);else if(T.depthBuffer){const Ue=T.depthTexture;if(ue.__boundDepthTexture!==Ue){if(Ue!==null&&Ce.has(Ue)&&(T.width!==Ue.image.width||T.height!==Ue.image.height))throw new Error("THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.");Ne.setupDepthRenderbuffer(T)}}const ve=T.texture;(ve.isData3DTexture||ve.isDataArrayTexture||ve.isCompressedArrayTexture)&&(he=!0);const Ee=Ce.get(T).__webglFramebuffer;T.isWebGLCubeRenderTarget?(Array.isArray(Ee[F])?z=Ee[F][$]:z=Ee[F],G=!0):T.samples>0&&Ne.useMultisampledRTT(T)===!1?z=Ce.get(T).__webglMultisampledFramebuffer:Array.isArray(Ee)?z=Ee[$]:z=Ee,ee.copy(T.viewport),Se.copy(T.scissor),De=T.scissorTest}else ee.copy(Re).multiplyScalar(ge).floor(),Se.copy(Ke).multiplyScalar(ge).floor(),De=st;if($!==0&&(z=O),pe.bindFramebuffer(B.FRAMEBUFFER,z)&&pe.drawBuffers(T,z),pe.viewport(ee),pe.scissor(Se),pe.setScissorTest(De),G){const ue=Ce.get(T.texture);B.framebufferTexture2D(B.FRAMEBUFFER,B.COLOR_ATTACHMENT0,B.TEXTURE_CUBE_MAP_POSITIVE_X+F,ue.__webglTexture,$)}else if(he){const ue=F;for(let ve=0;ve<T.textures.length;ve++){const Ee=Ce.get(T.textures[ve]);B.framebufferTextureLayer(B.FRAMEBUFFER,B.COLOR_ATTACHMENT0+ve,Ee.__webglTexture,$,ue)}}else if(T!==null&&$!==0){const ue=Ce.get(T.texture);B.framebufferTexture2D(B.FRAMEBUFFER,B.COLOR_ATTACHMENT0,B.TEXTURE_2D,ue.__webglTexture,$)}X=-1};function mm(T){const F=Ce.get(T);return(F.__readFormat!==T.format||F.__readType!==T.type)&&(F.__readFormat=T.format,F.__readType=T.type,F.__formatReadable=dt.textureFormatReadable(T.format),F.__typeReadable=dt.textureTypeReadable(T.type)),F}this.readRenderTargetPixels=function(T,F,$,z,G,he,Me,ue=0){if(!(T&&T.isWebGLRenderTarget)){Qe("WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let ve=Ce.get(T).__webglFramebuffer;if(T.isWebGLCubeRenderTarget&&Me!==void 0&&(ve=ve[Me],Array.isArray(ve)&&(ve=ve[0])),ve){pe.bindFramebuffer(B.FRAMEBUFFER,ve);try{const Ee=T.textures[ue],Ue=Ee.format,Xe=Ee.type;T.textures.length>1&&B.readBuffer(B.COLOR_ATTACHMENT0+ue);const ye=mm(Ee);if(ye.__formatReadable===!1){Qe("WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(ye.__typeReadable===!1){Qe("WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}F>=0&&F<=T.width-z&&$>=0&&$<=T.height-G&&B.readPixels(F,$,z,G,se.convert(Ue),se.convert(Xe),he)}finally{const Ee=te!==null?Ce.get(te).__webglFramebuffer:null;pe.bindFramebuffer(B.FRAMEBUFFER,Ee)}}},this.readRenderTargetPixelsAsync=async function(T,F,$,z,G,he,Me,ue=0){if(!(T&&T.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let ve=Ce.get(T).__webglFramebuffer;if(T.isWebGLCubeRenderTarget&&Me!==void 0&&(ve=ve[Me],Array.isArray(ve)&&(ve=ve[0])),ve)if(F>=0&&F<=T.width-z&&$>=0&&$<=T.height-G){pe.bindFramebuffer(B.FRAMEBUFFER,ve);const Ee=T.textures[ue],Ue=Ee.format,Xe=Ee.type;T.textures.length>1&&B.readBuffer(B.COLOR_ATTACHMENT0+ue);const ye=mm(Ee);if(ye.__formatReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(ye.__typeReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");const qe=B.createBuffer();B.bindBuffer(B.PIXEL_PACK_BUFFER,qe),B.bufferData(B.PIXEL_PACK_BUFFER,he.byteLength,B.STREAM_READ),B.readPixels(F,$,z,G,se.convert(Ue),se.convert(Xe),0),B.bindBuffer(B.PIXEL_PACK_BUFFER,null);const Et=te!==null?Ce.get(te).__webglFramebuffer:null;pe.bindFramebuffer(B.FRAMEBUFFER,Et);const ct=B.fenceSync(B.SYNC_GPU_COMMANDS_COMPLETE,0);return B.flush(),await a_(B,ct,4),B.bindBuffer(B.PIXEL_PACK_BUFFER,qe),B.getBufferSubData(B.PIXEL_PACK_BUFFER,0,he),B.bindBuffer(B.PIXEL_PACK_BUFFER,null),B.deleteBuffer(qe),B.deleteSync(ct),he}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")},this.copyFramebufferToTexture=function(T,F=null,$=0){const z=Math.pow(2,-$),G=Math.floor(T.image.width*z),he=Math.floor(T.image.height*z),Me=F!==null?F.x:0,ue=F!==null?F.y:0;Ne.setTexture2D(T,0),B.copyTexSubImage2D(B.TEXTURE_2D,$,0,0,Me,ue,G,he),pe.unbindTexture()},this.copyTextureToTexture=function(T,F,$=null,z=null,G=0,he=0){let Me,ue,ve,Ee,Ue,Xe,ye,qe,Et;const ct=T.isCompressedTexture?T.mipmaps[he]:T.image;if($!==null)Me=$.max.x-$.min.x,ue=$.max.y-$.min.y,ve=$.isBox3?$.max.z-$.min.z:1,Ee=$.min.x,Ue=$.min.y,Xe=$.isBox3?$.min.z:0;else{const Ze=Math.pow(2,-G);Me=Math.floor(ct.width*Ze),ue=Math.floor(ct.height*Ze),T.isDataArrayTexture?ve=ct.depth:T.isData3DTexture?ve=Math.floor(ct.depth*Ze):ve=1,Ee=0,Ue=0,Xe=0}z!==null?(ye=z.x,qe=z.y,Et=z.z):(ye=0,qe=0,Et=0);const at=se.convert(F.format),Zt=se.convert(F.type);let be;F.isData3DTexture?(Ne.setTexture3D(F,0),be=B.TEXTURE_3D):F.isDataArrayTexture||F.isCompressedArrayTexture?(Ne.setTexture2DArray(F,0),be=B.TEXTURE_2D_ARRAY):(Ne.setTexture2D(F,0),be=B.TEXTURE_2D),pe.activeTexture(B.TEXTURE0),pe.pixelStorei(B.UNPACK_FLIP_Y_WEBGL,F.flipY),pe.pixelStorei(B.UNPACK_PREMULTIPLY_ALPHA_WEBGL,F.premultiplyAlpha),pe.pixelStorei(B.UNPACK_ALIGNMENT,F.unpackAlignment);const an=pe.getParameter(B.UNPACK_ROW_LENGTH),je=pe.getParameter(B.UNPACK_IMAGE_HEIGHT),Ir=pe.getParameter(B.UNPACK_SKIP_PIXELS),Jt=pe.getParameter(B.UNPACK_SKIP_ROWS),fl=pe.getParameter(B.UNPACK_SKIP_IMAGES);pe.pixelStorei(B.UNPACK_ROW_LENGTH,ct.width),pe.pixelStorei(B.UNPACK_IMAGE_HEIGHT,ct.height),pe.pixelStorei(B.UNPACK_SKIP_PIXELS,Ee),pe.pixelStorei(B.UNPACK_SKIP_ROWS,Ue),pe.pixelStorei(B.UNPACK_SKIP_IMAGES,Xe);const sr=T.isDataArrayTexture||T.isData3DTexture,Nr=F.isDataArrayTexture||F.isData3DTexture;if(T.isDepthTexture){const Ze=Ce.get(T),Vt=Ce.get(F),zn=Ce.get(Ze.__renderTarget),mt=Ce.get(Vt.__renderTarget);pe.bindFramebuffer(B.READ_FRAMEBUFFER,zn.__webglFramebuffer),pe.bindFramebuffer(B.DRAW_FRAMEBUFFER,mt.__webglFramebuffer);for(let Ot=0;Ot<ve;Ot++)sr&&(B.framebufferTextureLayer(B.READ_FRAMEBUFFER,B.COLOR_ATTACHMENT0,Ce.get(T).__webglTexture,G,Xe+Ot),B.framebufferTextureLayer(B.DRAW_FRAMEBUFFER,B.COLOR_ATTACHMENT0,Ce.get(F).__webglTexture,he,Et+Ot)),B.blitFramebuffer(Ee,Ue,Ee+Me,Ue+ue,ye,qe,ye+Me,qe+ue,B.DEPTH_BUFFER_BIT,B.NEAREST);pe.bindFramebuffer(B.READ_FRAMEBUFFER,null),pe.bindFramebuffer(B.DRAW_FRAMEBUFFER,null)}else if(G!==0||T.isRenderTargetTexture||Ce.has(T)){const Ze=Ce.get(T),Vt=Ce.get(F);pe.bindFramebuffer(B.READ_FRAMEBUFFER,L),pe.bindFramebuffer(B.DRAW_FRAMEBUFFER,k);for(let zn=0;zn<ve;zn++)sr?B.framebufferTextureLayer(B.READ_FRAMEBUFFER,B.COLOR_ATTACHMENT0,Ze.__webglTexture,G,Xe+zn):B.framebufferTexture2D(B.READ_FRAMEBUFFER,B.COLOR_ATTACHMENT0,B.TEXTURE_2D,Ze.__webglTexture,G),Nr?B.framebufferTextureLayer(B.DRAW_FRAMEBUFFER,B.COLOR_ATTACHMENT0,Vt.__webglTexture,he,Et+zn):B.framebufferTexture2D(B.DRAW_FRAMEBUFFER,B.COLOR_ATTACHMENT0,B.TEXTURE_2D,Vt.__webglTexture,he),G!==0?B.blitFramebuffer(Ee,Ue,Ee+Me,Ue+ue,ye,qe,ye+Me,qe+ue,B.COLOR_BUFFER_BIT,B.NEAREST):Nr?B.copyTexSubImage3D(be,he,ye,qe,Et+zn,Ee,Ue,Me,ue):B.copyTexSubImage2D(be,he,ye,qe,Ee,Ue,Me,ue);pe.bindFramebuffer(B.READ_FRAMEBUFFER,null),pe.bindFramebuffer(B.DRAW_FRAMEBUFFER,null)}else Nr?T.isDataTexture||T.isData3DTexture?B.texSubImage3D(be,he,ye,qe,Et,Me,ue,ve,at,Zt,ct.data):F.isCompressedArrayTexture?B.compressedTexSubImage3D(be,he,ye,qe,Et,Me,ue,ve,at,ct.data):B.texSubImage3D(be,he,ye,qe,Et,Me,ue,ve,at,Zt,ct):T.isDataTexture?B.texSubImage2D(B.TEXTURE_2D,he,ye,qe,Me,ue,at,Zt,ct.data):T.isCompressedTexture?B.compressedTexSubImage2D(B.TEXTURE_2D,he,ye,qe,ct.width,ct.height,at,ct.data):B.texSubImage2D(B.TEXTURE_2D,he,ye,qe,Me,ue,at,Zt,ct);pe.pixelStorei(B.UNPACK_ROW_LENGTH,an),pe.pixelStorei(B.UNPACK_IMAGE_HEIGHT,je),pe.pixelStorei(B.UNPACK_SKIP_PIXELS,Ir),pe.pixelStorei(B.UNPACK_SKIP_ROWS,Jt),pe.pixelStorei(B.UNPACK_SKIP_IMAGES,fl),he===0&&F.generateMipmaps===!0&&F.mipmapsAutoUpdate===!0&&B.generateMipmap(be),pe.unbindTexture()},this.initRenderTarget=function(T){Ce.get(T).__webglFramebuffer===void 0&&Ne.setupRenderTarget(T)},this.initTexture=function(T){T.isCubeTexture?Ne.setTextureCube(T,0):T.isData3DTexture?Ne.setTexture3D(T,0):T.isDataArrayTexture||T.isCompressedArrayTexture?Ne.setTexture2DArray(T,0):Ne.setTexture2D(T,0),pe.unbindTexture()},this.resetState=function(){V=0,W=0,te=null,pe.reset(),oe.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return Ln}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(e){this._outputColorSpace=e;const t=this.getContext();t.drawingBufferColorSpace=Ye._getDrawingBufferColorSpace(e),t.unpackColorSpace=Ye._getUnpackColorSpace()}}const Zh=0,oM=1,lM=2,Jh=2,du=1.25,Qh=1,hn=32,yt=hn/4,jh=65535,Ro=Math.pow(2,-24),hu=Symbol("SKIP_GENERATION"),ep={strategy:Zh,maxDepth:40,targetLeafSize:10,useSharedArrayBuffer:!1,setBoundingBox:!0,onProgress:null,indirect:!1,verbose:!0,range:null,[hu]:!1};function gt(n,e,t){return t.min.x=e[n],t.min.y=e[n+1],t.min.z=e[n+2],t.max.x=e[n+3],t.max.y=e[n+4],t.max.z=e[n+5],t}function pu(n){let e=-1,t=-1/0;for(let i=0;i<3;i++){const r=n[i+3]-n[i];r>t&&(t=r,e=i)}return e}function tp(n,e,t){for(let i=0;i<3;i++){const r=e[n+2*i],s=e[n+2*i+1],a=r-s,o=r+s;a<t[i]&&(t[i]=a),o>t[i+3]&&(t[i+3]=o)}}function mu(n){const e=n[3]-n[0],t=n[4]-n[1],i=n[5]-n[2];return 2*(e*t+t*i+i*e)}function xt(n,e){return e[n+15]===jh}function Nt(n,e){return e[n+6]}function qt(n,e){return e[n+14]}function Rt(n){return n+yt}function Ct(n,e){const t=e[n+6];return n+t*yt}function gu(n,e){return e[n+7]}function WE(n){return n}function _u(n,e,t,i,r){let s=1/0,a=1/0,o=1/0,l=-1/0,c=-1/0,f=-1/0,d=1/0,u=1/0,h=1/0,g=-1/0,x=-1/0,m=-1/0;const p=n.offset||0;for(let v=(e-p)*6,y=(e+t-p)*6;v<y;v+=6){const S=n[v+0],E=n[v+1],A=S-E,_=S+E;A<s&&(s=A),_>l&&(l=_),S<d&&(d=S),S>g&&(g=S);const b=n[v+2],I=n[v+3],R=b-I,P=b+I;R<a&&(a=R),P>c&&(c=P),b<u&&(u=b),b>x&&(x=b);const D=n[v+4],O=n[v+5],L=D-O,k=D+O;L<o&&(o=L),k>f&&(f=k),D<h&&(h=D),D>m&&(m=D)}i[0]=s,i[1]=a,i[2]=o,i[3]=l,i[4]=c,i[5]=f,r[0]=d,r[1]=u,r[2]=h,r[3]=g,r[4]=x,r[5]=m}const Jn=8,vu=8,xu=new Int32Array(Jn),Qn=new Float32Array(Jn*6),cs=new Float32Array(Jn*6),On=new Float32Array(6),Co=new Float32Array(6),Xi=new Int32Array(vu),np=new Float32Array(vu*6);function cM(n,e,t,i){for(let r=0;r<3;r++){const s=e[n+2*r],a=e[n+2*r+1],o=s-a,l=s+a;o<t[i+r]&&(t[i+r]=o),l>t[i+r+3]&&(t[i+r+3]=l)}}function ip(n,e){const t=n[e+3]-n[e],i=n[e+4]-n[e+1],r=n[e+5]-n[e+2];return 2*(t*i+i*r+r*t)}function uM(n,e,t,i,r,s){let a=-1,o=0;if(s===Zh)a=pu(e),a!==-1&&(o=(e[a]+e[a+3])/2);else if(s===oM)a=pu(n),a!==-1&&(o=fM(t,i,r,a));else if(s===lM){const l=mu(n);let c=du*r;const f=t.offset||0,d=(i-f)*6,u=(i+r-f)*6;for(let h=0;h<3;h++){const g=e[h],p=(e[h+3]-g)/Jn;if(r<vu){for(let v=0;v<r;v++){const y=d+v*6,S=t[y+2*h];let E=v;for(;E>0&&t[Xi[E-1]+2*h]>S;)Xi[E]=Xi[E-1],E--;Xi[E]=y}for(let v=0;v<3;v++)On[v]=1/0,On[v+3]=-1/0,Co[v]=1/0,Co[v+3]=-1/0;for(let v=r-1;v>=0;v--)tp(Xi[v],t,Co),np.set(Co,v*6);for(let v=0;v<r-1;v++){tp(Xi[v],t,On);const y=t[Xi[v+1]+2*h];if(t[Xi[v]+2*h]===y)continue;const S=v+1,E=r-S,A=mu(On)/l,_=ip(np,S*6)/l,b=Qh+du*(A*S+_*E);b<c&&(a=h,c=b,o=y)}}else{for(let S=0;S<Jn;S++){xu[S]=0;for(let E=0;E<3;E++)Qn[S*6+E]=1/0,Qn[S*6+E+3]=-1/0}for(let S=d;S<u;S+=6){let _=~~((t[S+2*h]-g)/p);_>=Jn&&(_=Jn-1),xu[_]++,cM(S,t,Qn,_*6)}const v=(Jn-1)*6;for(let S=0;S<6;S++)cs[v+S]=Qn[v+S];for(let S=Jn-2;S>=0;S--){const E=S*6,A=E+6;for(let _=0;_<3;_++)cs[E+_]=Math.min(Qn[E+_],cs[A+_]),cs[E+_+3]=Math.max(Qn[E+_+3],cs[A+_+3])}let y=0;for(let S=0;S<Jn-1;S++){const E=S*6,A=xu[S];if(A!==0)for(let P=0;P<3;P++)y===0?(On[P]=Qn[E+P],On[P+3]=Qn[E+P+3]):(On[P]=Math.min(On[P],Qn[E+P]),On[P+3]=Math.max(On[P+3],Qn[E+P+3]));y+=A;let _=0,b=0;y!==0&&(_=mu(On)/l);const I=r-y;I!==0&&(b=ip(cs,E+6)/l);const R=Qh+du*(_*y+b*I);R<c&&(a=h,c=R,o=g+p+S*p)}}}}else console.warn(`BVH: Invalid build strategy value ${s} used.`);return{axis:a,pos:o}}function fM(n,e,t,i){let r=0;const s=n.offset;for(let a=e,o=e+t;a<o;a++)r+=n[(a-s)*6+i*2];return r/t}function dM(n,e,t,i,r,s){let a=i,o=i+r-1;const l=s.pos,c=s.axis*2,f=t.offset||0;for(;;){for(;a<=o&&t[(a-f)*6+c]<l;)a++;for(;a<=o&&t[(o-f)*6+c]>=l;)o--;if(a<o){for(let d=0;d<e;d++){let u=n[a*e+d];n[a*e+d]=n[o*e+d],n[o*e+d]=u}for(let d=0;d<6;d++){const u=a-f,h=o-f,g=t[u*6+d];t[u*6+d]=t[h*6+d],t[h*6+d]=g}a++,o--}else return a}}const hM=Math.pow(2,32),us=new Float32Array(6),Po=new Float32Array(6);function pM(n,e,t,i,r,s){const{maxDepth:a,verbose:o,targetLeafSize:l,_strictLeafSize:c=1/0,strategy:f,onProgress:d,useSharedArrayBuffer:u=!1}=r,h=n.primitiveBuffer,g=n.primitiveBufferStride,x=u?SharedArrayBuffer:ArrayBuffer,m=new x(hn*Math.max(1,2*Math.ceil(i)-1)),p=new Float32Array(m),v=new Uint32Array(m),y=new Uint16Array(m);let S=0,E=!1;return _u(e,t,i,us,Po),b(t,i,0),m.slice(0,S*hn);function A(I){d&&d((I-s.offset)/s.count)}function _(I,R,P){const D=I*2;v[I+6]=R,y[D+14]=P,y[D+15]=jh,A(R+P)}function b(I,R,P){const D=S++,O=D*yt;p.set(us,O),!E&&P>=a&&(E=!0,o&&console.warn(`BVH: Max depth of ${a} reached when generating BVH. Consider increasing maxDepth.`));const L=R>c;if(R<=l&&!L||P>=a){_(O,I,R);return}const k=uM(us,Po,e,I,R,f);let V=k.axis===-1?-1:dM(h,g,e,I,R,k);if(k.axis===-1||V===I||V===I+R){if(!L){_(O,I,R);return}k.axis=Math.max(0,pu(us)),V=I+Math.max(1,Math.floor(R/2))}v[O+7]=k.axis;const W=V-I;_u(e,I,W,us,Po),b(I,W,P+1);const te=S-D;if(te>hM)throw new Error("MeshBVH: Cannot store relative child node offset greater than 32 bits.");v[O+6]=te;const X=R-W;_u(e,V,X,us,Po),b(V,X,P+1)}}function mM(n,e){const t=n.getRootRanges(e.range),i=t[0],r=t[t.length-1],s={offset:i.offset,count:r.offset+r.count-i.offset},a=new Float32Array(6*s.count);a.offset=s.offset,n.computePrimitiveBounds(s.offset,s.count,a),n._roots=t.map(o=>pM(n,a,o.offset,o.count,e,s))}class Su{constructor(e){this._getNewPrimitive=e,this._primitives=[]}getPrimitive(){const e=this._primitives;return e.length===0?this._getNewPrimitive():e.pop()}releasePrimitive(e){this._primitives.push(e)}}class gM{constructor(){this.float32Array=null,this.uint16Array=null,this.uint32Array=null;const e=[];let t=null;this.setBuffer=i=>{t&&e.push(t),t=i,this.float32Array=new Float32Array(i),this.uint16Array=new Uint16Array(i),this.uint32Array=new Uint32Array(i)},this.clearBuffer=()=>{t=null,this.float32Array=null,this.uint16Array=null,this.uint32Array=null,e.length!==0&&this.setBuffer(e.pop())}}}const it=new gM;let qi,fs;const ds=[],Lo=new Su(()=>new nn);function _M(n,e,t,i,r,s){qi=Lo.getPrimitive(),fs=Lo.getPrimitive(),ds.push(qi,fs),it.setBuffer(n._roots[e]);const a=Mu(0,n.geometry,t,i,r,s);it.clearBuffer(),Lo.releasePrimitive(qi),Lo.releasePrimitive(fs),ds.pop(),ds.pop();const o=ds.length;return o>0&&(fs=ds[o-1],qi=ds[o-2]),a}function Mu(n,e,t,i,r=null,s=0,a=0){const{float32Array:o,uint16Array:l,uint32Array:c}=it;let f=n*2;if(xt(f,l)){const u=Nt(n,c),h=qt(f,l);return gt(n,o,qi),i(u,h,!1,a,s+n/yt,qi)}else{let R=function(D){const{uint16Array:O,uint32Array:L}=it;let k=D*2;for(;!xt(k,O);)D=Rt(D),k=D*2;return Nt(D,L)},P=function(D){const{uint16Array:O,uint32Array:L}=it;let k=D*2;for(;!xt(k,O);)D=Ct(D,L),k=D*2;return Nt(D,L)+qt(k,O)};const u=Rt(n),h=Ct(n,c);let g=u,x=h,m,p,v,y;if(r&&(v=qi,y=fs,gt(g,o,v),gt(x,o,y),m=r(v),p=r(y),p<m)){g=h,x=u;const D=m;m=p,p=D,v=y}v||(v=qi,gt(g,o,v));const S=xt(g*2,l),E=t(v,S,m,a+1,s+g/yt);let A;if(E===Jh){const D=R(g),L=P(g)-D;A=i(D,L,!0,a+1,s+g/yt,v)}else A=E&&Mu(g,e,t,i,r,s,a+1);if(A)return!0;y=fs,gt(x,o,y);const _=xt(x*2,l),b=t(y,_,p,a+1,s+x/yt);let I;if(b===Jh){const D=R(x),L=P(x)-D;I=i(D,L,!0,a+1,s+x/yt,y)}else I=b&&Mu(x,e,t,i,r,s,a+1);return!!I}}const ea=new it.constructor,Do=new it.constructor,Yi=new Su(()=>new nn),hs=new nn,ps=new nn,yu=new nn,bu=new nn;let Eu=!1;function vM(n,e,t,i){if(Eu)throw new Error("MeshBVH: Recursive calls to bvhcast not supported.");Eu=!0;const r=n._roots,s=e._roots;let a,o=0,l=0;const c=new tt().copy(t).invert();for(let f=0,d=r.length;f<d;f++){ea.setBuffer(r[f]),l=0;const u=Yi.getPrimitive();gt(0,ea.float32Array,u),u.applyMatrix4(c);for(let h=0,g=s.length;h<g&&(Do.setBuffer(s[h]),a=Bn(0,0,t,c,i,o,l,0,0,u),Do.clearBuffer(),l+=s[h].byteLength/hn,!a);h++);if(Yi.releasePrimitive(u),ea.clearBuffer(),o+=r[f].byteLength/hn,a)break}return Eu=!1,a}function Bn(n,e,t,i,r,s=0,a=0,o=0,l=0,c=null,f=!1){let d,u;f?(d=Do,u=ea):(d=ea,u=Do);const h=d.float32Array,g=d.uint32Array,x=d.uint16Array,m=u.float32Array,p=u.uint32Array,v=u.uint16Array,y=n*2,S=e*2,E=xt(y,x),A=xt(S,v);let _=!1;if(A&&E)f?_=r(Nt(e,p),qt(e*2,v),Nt(n,g),qt(n*2,x),l,a+e/yt,o,s+n/yt):_=r(Nt(n,g),qt(n*2,x),Nt(e,p),qt(e*2,v),o,s+n/yt,l,a+e/yt);else if(A){const b=Yi.getPrimitive();gt(e,m,b),b.applyMatrix4(t);const I=Rt(n),R=Ct(n,g);gt(I,h,hs),gt(R,h,ps);const P=b.intersectsBox(hs),D=b.intersectsBox(ps);_=P&&Bn(e,I,i,t,r,a,s,l,o+1,b,!f)||D&&Bn(e,R,i,t,r,a,s,l,o+1,b,!f),Yi.releasePrimitive(b)}else{const b=Rt(e),I=Ct(e,p);gt(b,m,yu),gt(I,m,bu);const R=c.intersectsBox(yu),P=c.intersectsBox(bu);if(R&&P)_=Bn(n,b,t,i,r,s,a,o,l+1,c,f)||Bn(n,I,t,i,r,s,a,o,l+1,c,f);else if(R)if(E)_=Bn(n,b,t,i,r,s,a,o,l+1,c,f);else{const D=Yi.getPrimitive();D.copy(yu).applyMatrix4(t);const O=Rt(n),L=Ct(n,g);gt(O,h,hs),gt(L,h,ps);const k=D.intersectsBox(hs),V=D.intersectsBox(ps);_=k&&Bn(b,O,i,t,r,a,s,l,o+1,D,!f)||V&&Bn(b,L,i,t,r,a,s,l,o+1,D,!f),Yi.releasePrimitive(D)}else if(P)if(E)_=Bn(n,I,t,i,r,s,a,o,l+1,c,f);else{const D=Yi.getPrimitive();D.copy(bu).applyMatrix4(t);const O=Rt(n),L=Ct(n,g);gt(O,h,hs),gt(L,h,ps);const k=D.intersectsBox(hs),V=D.intersectsBox(ps);_=k&&Bn(I,O,i,t,r,a,s,l,o+1,D,!f)||V&&Bn(I,L,i,t,r,a,s,l,o+1,D,!f),Yi.releasePrimitive(D)}}return _}const wu=new class{constructor(){let n=null,e=null,t=null,i=!1;this.root=null,this.buffer=null,this.uint32Array=null,this.uint16Array=null,this.setBVH=(s,a)=>{if(i)throw new Error("BVHTraversalHelper: cannot call setBVH during an active traversal.");this.root=a,this.buffer=n=s._roots[a],this.uint16Array=t=new Uint16Array(n),this.uint32Array=e=new Uint32Array(n)},this.reset=()=>{this.root=null,this.buffer=n=null,this.uint16Array=t=null,this.uint32Array=e=null},this.getRangeStart=s=>{let a=s*2;for(;!xt(a,t);)s=Rt(s),a=s*2;return Nt(s,e)},this.getRangeEnd=s=>{let a=s*2;for(;!xt(a,t);)s=Ct(s,e),a=s*2;return Nt(s,e)+qt(a,t)};const r=(s,a,o)=>{const l=a*2,c=xt(l,t);if(!s(o,c,a)&&!c){const d=Rt(a),u=Ct(a,e);r(s,d,o+1),r(s,u,o+1)}};this.traverseBuffer=s=>{if(i)throw new Error("BVHTraversalHelper: cannot start a traversal during an active traversal.");i=!0;try{r(s,0,0)}finally{i=!1}},this.traverse=s=>{this.traverseBuffer((a,o,l)=>{if(o){const c=l*2,f=e[l+6],d=t[c+14];return s(a,o,new Float32Array(n,l*4,6),f,d)}else{const c=gu(l,e);return s(a,o,new Float32Array(n,l*4,6),c)}})}}},rp=new nn,ms=new Float32Array(6);class xM{constructor(){this._roots=null,this.primitiveBuffer=null,this.primitiveBufferStride=null}init(e){e={...ep,...e},"maxLeafSize"in e&&(console.warn('BVH: "maxLeafSize" option has been deprecated. Use "targetLeafSize", instead.'),e={...e,targetLeafSize:e.maxLeafSize}),mM(this,e)}getRootRanges(){throw new Error("BVH: getRootRanges() not implemented")}writePrimitiveBounds(){throw new Error("BVH: writePrimitiveBounds() not implemented")}writePrimitiveRangeBounds(e,t,i,r){let s=1/0,a=1/0,o=1/0,l=-1/0,c=-1/0,f=-1/0;for(let d=e,u=e+t;d<u;d++){this.writePrimitiveBounds(d,ms,0);const[h,g,x,m,p,v]=ms;h<s&&(s=h),m>l&&(l=m),g<a&&(a=g),p>c&&(c=p),x<o&&(o=x),v>f&&(f=v)}return i[r+0]=s,i[r+1]=a,i[r+2]=o,i[r+3]=l,i[r+4]=c,i[r+5]=f,i}computePrimitiveBounds(e,t,i){const r=i.offset||0;for(let s=e,a=e+t;s<a;s++){this.writePrimitiveBounds(s,ms,0);const[o,l,c,f,d,u]=ms,h=(o+f)/2,g=(l+d)/2,x=(c+u)/2,m=(f-o)/2,p=(d-l)/2,v=(u-c)/2,y=(s-r)*6;i[y+0]=h,i[y+1]=m+(Math.abs(h)+m)*Ro,i[y+2]=g,i[y+3]=p+(Math.abs(g)+p)*Ro,i[y+4]=x,i[y+5]=v+(Math.abs(x)+v)*Ro}return i}shiftPrimitiveOffsets(e){const t=this._indirectBuffer;if(t)for(let i=0,r=t.length;i<r;i++)t[i]+=e;else{const i=this._roots;for(let r=0;r<i.length;r++){const s=i[r],a=new Uint32Array(s),o=new Uint16Array(s),l=s.byteLength/hn;for(let c=0;c<l;c++){const f=yt*c,d=2*f;xt(d,o)&&(a[f+6]+=e)}}}}traverse(e,t=0){wu.setBVH(this,t),wu.traverse(e),wu.reset()}refit(){const e=this._roots;for(let t=0,i=e.length;t<i;t++){const r=e[t],s=new Uint32Array(r),a=new Uint16Array(r),o=new Float32Array(r),l=r.byteLength/hn;for(let c=l-1;c>=0;c--){const f=c*yt,d=f*2;if(xt(d,a)){const h=Nt(f,s),g=qt(d,a);this.writePrimitiveRangeBounds(h,g,ms,0),o.set(ms,f)}else{const h=Rt(f),g=Ct(f,s);for(let x=0;x<3;x++){const m=o[h+x],p=o[h+x+3],v=o[g+x],y=o[g+x+3];o[f+x]=m<v?m:v,o[f+x+3]=p>y?p:y}}}}}getBoundingBox(e){return e.makeEmpty(),this._roots.forEach(i=>{gt(0,new Float32Array(i),rp),e.union(rp)}),e}shapecast(e){let{boundsTraverseOrder:t,intersectsBounds:i,intersectsRange:r,intersectsPrimitive:s,scratchPrimitive:a,iterate:o}=e;if(r&&s){const d=r;r=(u,h,g,x,m)=>d(u,h,g,x,m)?!0:o(u,h,this,s,g,x,a)}else r||(s?r=(d,u,h,g)=>o(d,u,this,s,h,g,a):r=(d,u,h)=>h);let l=!1,c=0;const f=this._roots;for(let d=0,u=f.length;d<u;d++){const h=f[d];if(l=_M(this,d,i,r,t,c),l)break;c+=h.byteLength/hn}return l}bvhcast(e,t,i){let{intersectsRanges:r}=i;return vM(this,e,t,r)}}function SM(){return typeof SharedArrayBuffer<"u"}function Tu(n){return n.index?n.index.count:n.attributes.position.count}function Io(n){return Tu(n)/3}function MM(n,e=ArrayBuffer){return n>65535?new Uint32Array(new e(4*n)):new Uint16Array(new e(2*n))}function yM(n,e){if(!n.index){const t=n.attributes.position.count,i=e.useSharedArrayBuffer?SharedArrayBuffer:ArrayBuffer,r=MM(t,i);n.setIndex(new Ht(r,1));for(let s=0;s<t;s++)r[s]=s}}function bM(n,e,t){const i=Tu(n)/t,r=e||n.drawRange,s=r.start/t,a=(r.start+r.count)/t,o=Math.max(0,s),l=Math.min(i,a)-o;return{offset:Math.floor(o),count:Math.floor(l)}}function EM(n,e){return n.groups.map(t=>({offset:t.start/e,count:t.count/e}))}function sp(n,e,t){const i=bM(n,e,t),r=EM(n,t);if(!r.length)return[i];const s=[],a=i.offset,o=i.offset+i.count,l=Tu(n)/t,c=[];for(const u of r){const{offset:h,count:g}=u,x=h,m=isFinite(g)?g:l-h,p=h+m;x<o&&p>a&&(c.push({pos:Math.max(a,x),isStart:!0}),c.push({pos:Math.min(o,p),isStart:!1}))}c.sort((u,h)=>u.pos!==h.pos?u.pos-h.pos:u.type==="end"?-1:1);let f=0,d=null;for(const u of c){const h=u.pos;f!==0&&h!==d&&s.push({offset:d,count:h-d}),f+=u.isStart?1:-1,d=h}return s}function wM(n,e){const t=n[n.length-1],i=t.offset+t.count>2**16,r=n.reduce((c,f)=>c+f.count,0),s=i?4:2,a=e?new SharedArrayBuffer(r*s):new ArrayBuffer(r*s),o=i?new Uint32Array(a):new Uint16Array(a);let l=0;for(let c=0;c<n.length;c++){const{offset:f,count:d}=n[c];for(let u=0;u<d;u++)o[l+u]=f+u;l+=d}return o}class TM extends xM{get indirect(){return!!this._indirectBuffer}get primitiveStride(){return null}get primitiveBufferStride(){return this.indirect?1:this.primitiveStride}set primitiveBufferStride(e){}get primitiveBuffer(){return this.indirect?this._indirectBuffer:this.geometry.index.array}set primitiveBuffer(e){}constructor(e,t={}){if(e.isBufferGeometry){if(e.index&&e.index.isInterleavedBufferAttribute)throw new Error("BVH: InterleavedBufferAttribute is not supported for the index attribute.")}else throw new Error("BVH: Only BufferGeometries are supported.");if(t.useSharedArrayBuffer&&!SM())throw new Error("BVH: SharedArrayBuffer is not available.");super(),this.geometry=e,this.resolvePrimitiveIndex=t.indirect?i=>this._indirectBuffer[i]:i=>i,this.primitiveBuffer=null,this.primitiveBufferStride=null,this._indirectBuffer=null,t={...ep,...t},t[hu]||this.init(t)}init(e){const{geometry:t,primitiveStride:i}=this;if(e.indirect){const r=sp(t,e.range,i),s=wM(r,e.useSharedArrayBuffer);this._indirectBuffer=s}else yM(t,e);super.init(e),!t.boundingBox&&e.setBoundingBox&&(t.boundingBox=this.getBoundingBox(new nn))}getRootRanges(e){return this.indirect?[{offset:0,count:this._indirectBuffer.length}]:sp(this.geometry,e,this.primitiveStride)}raycastObject3D(){throw new Error("BVH: raycastObject3D() not implemented")}}class Ei{constructor(){this.min=1/0,this.max=-1/0}setFromPointsField(e,t){let i=1/0,r=-1/0;for(let s=0,a=e.length;s<a;s++){const l=e[s][t];i=l<i?l:i,r=l>r?l:r}this.min=i,this.max=r}setFromPoints(e,t){let i=1/0,r=-1/0;for(let s=0,a=t.length;s<a;s++){const o=t[s],l=e.dot(o);i=l<i?l:i,r=l>r?l:r}this.min=i,this.max=r}isSeparated(e){return this.min>e.max||e.min>this.max}}Ei.prototype.setFromBox=(function(){const n=new N;return function(t,i){const r=i.min,s=i.max;let a=1/0,o=-1/0;for(let l=0;l<=1;l++)for(let c=0;c<=1;c++)for(let f=0;f<=1;f++){n.x=r.x*l+s.x*(1-l),n.y=r.y*c+s.y*(1-c),n.z=r.z*f+s.z*(1-f);const d=t.dot(n);a=Math.min(d,a),o=Math.max(d,o)}this.min=a,this.max=o}})();const AM=(function(){const n=new N,e=new N,t=new N;return function(r,s,a){const o=r.start,l=n,c=s.start,f=e;t.subVectors(o,c),n.subVectors(r.end,r.start),e.subVectors(s.end,s.start);const d=t.dot(f),u=f.dot(l),h=f.dot(f),g=t.dot(l),m=l.dot(l)*h-u*u;let p,v;m!==0?p=(d*u-g*h)/m:p=0,v=(d+p*u)/h,a.x=p,a.y=v}})(),Au=(function(){const n=new We,e=new N,t=new N;return function(r,s,a,o){AM(r,s,n);let l=n.x,c=n.y;if(l>=0&&l<=1&&c>=0&&c<=1){r.at(l,a),s.at(c,o);return}else if(l>=0&&l<=1){c<0?s.at(0,o):s.at(1,o),r.closestPointToPoint(o,!0,a);return}else if(c>=0&&c<=1){l<0?r.at(0,a):r.at(1,a),s.closestPointToPoint(a,!0,o);return}else{let f;l<0?f=r.start:f=r.end;let d;c<0?d=s.start:d=s.end;const u=e,h=t;if(r.closestPointToPoint(d,!0,e),s.closestPointToPoint(f,!0,t),u.distanceToSquared(d)<=h.distanceToSquared(f)){a.copy(u),o.copy(d);return}else{a.copy(f),o.copy(h);return}}}})(),RM=(function(){const n=new N,e=new N,t=new qn,i=new bi;return function(s,a){const{radius:o,center:l}=s,{a:c,b:f,c:d}=a;if(i.start=c,i.end=f,i.closestPointToPoint(l,!0,n).distanceTo(l)<=o||(i.start=c,i.end=d,i.closestPointToPoint(l,!0,n).distanceTo(l)<=o)||(i.start=f,i.end=d,i.closestPointToPoint(l,!0,n).distanceTo(l)<=o))return!0;const x=a.getPlane(t);if(Math.abs(x.distanceToPoint(l))<=o){const p=x.projectPoint(l,e);if(a.containsPoint(p))return!0}return!1}})(),CM=["x","y","z"],wi=1e-15,ap=wi*wi;function bn(n){return Math.abs(n)<wi}class kn extends zt{constructor(...e){super(...e),this.isExtendedTriangle=!0,this.satAxes=new Array(4).fill().map(()=>new N),this.satBounds=new Array(4).fill().map(()=>new Ei),this.points=[this.a,this.b,this.c],this.plane=new qn,this.isDegenerateIntoSegment=!1,this.isDegenerateIntoPoint=!1,this.degenerateSegment=new bi,this.needsUpdate=!0}intersectsSphere(e){return RM(e,this)}update(){const e=this.a,t=this.b,i=this.c,r=this.points,s=this.satAxes,a=this.satBounds,o=s[0],l=a[0];this.getNormal(o),l.setFromPoints(o,r);const c=s[1],f=a[1];c.subVectors(e,t),f.setFromPoints(c,r);const d=s[2],u=a[2];d.subVectors(t,i),u.setFromPoints(d,r);const h=s[3],g=a[3];h.subVectors(i,e),g.setFromPoints(h,r);const x=c.length(),m=d.length(),p=h.length();this.isDegenerateIntoPoint=!1,this.isDegenerateIntoSegment=!1,x<wi?m<wi||p<wi?this.isDegenerateIntoPoint=!0:(this.isDegenerateIntoSegment=!0,this.degenerateSegment.start.copy(e),this.degenerateSegment.end.copy(i)):m<wi?p<wi?this.isDegenerateIntoPoint=!0:(this.isDegenerateIntoSegment=!0,this.degenerateSegment.start.copy(t),this.degenerateSegment.end.copy(e)):p<wi&&(this.isDegenerateIntoSegment=!0,this.degenerateSegment.start.copy(i),this.degenerateSegment.end.copy(t)),this.plane.setFromNormalAndCoplanarPoint(o,e),this.needsUpdate=!1}}kn.prototype.closestPointToSegment=(function(){const n=new N,e=new N,t=new bi;return function(r,s=null,a=null){this.needsUpdate&&this.update();const{start:o,end:l}=r,c=this.points;let f,d=1/0;const u=this.plane.distanceToPoint(o),h=this.plane.distanceToPoint(l);if(u*h<0&&this.plane.intersectLine(r,n)!==null&&this.containsPoint(n))return s&&s.copy(n),a&&a.copy(n),0;for(let g=0;g<3;g++){const x=(g+1)%3;t.start.copy(c[g]),t.end.copy(c[x]),Au(t,r,n,e),f=n.distanceToSquared(e),f<d&&(d=f,s&&s.copy(n),a&&a.copy(e))}return this.closestPointToPoint(o,n),f=o.distanceToSquared(n),f<d&&(d=f,s&&s.copy(n),a&&a.copy(o)),this.closestPointToPoint(l,n),f=l.distanceToSquared(n),f<d&&(d=f,s&&s.copy(n),a&&a.copy(l)),Math.sqrt(d)}})(),kn.prototype.intersectsTriangle=(function(){const n=new kn,e=new Ei,t=new Ei,i=new N,r=new N,s=new N,a=new N,o=new bi,l=new bi,c=new N,f=new We,d=new We;function u(y,S,E,A){const _=i;!y.isDegenerateIntoPoint&&!y.isDegenerateIntoSegment?_.copy(y.plane.normal):_.copy(S.plane.normal);const b=y.satBounds,I=y.satAxes;for(let D=1;D<4;D++){const O=b[D],L=I[D];if(e.setFromPoints(L,S.points),O.isSeparated(e)||(a.copy(_).cross(L),e.setFromPoints(a,y.points),t.setFromPoints(a,S.points),e.isSeparated(t)))return!1}const R=S.satBounds,P=S.satAxes;for(let D=1;D<4;D++){const O=R[D],L=P[D];if(e.setFromPoints(L,y.points),O.isSeparated(e)||(a.crossVectors(_,L),e.setFromPoints(a,y.points),t.setFromPoints(a,S.points),e.isSeparated(t)))return!1}return E&&(A||console.warn("ExtendedTriangle.intersectsTriangle: Triangles are coplanar which does not support an output edge. Setting edge to 0, 0, 0."),E.start.set(0,0,0),E.end.set(0,0,0)),!0}function h(y,S,E,A,_,b,I,R,P,D,O){let L=I/(I-R);D.x=A+(_-A)*L,O.start.subVectors(S,y).multiplyScalar(L).add(y),L=I/(I-P),D.y=A+(b-A)*L,O.end.subVectors(E,y).multiplyScalar(L).add(y)}function g(y,S,E,A,_,b,I,R,P,D,O){if(_>0)h(y.c,y.a,y.b,A,S,E,P,I,R,D,O);else if(b>0)h(y.b,y.a,y.c,E,S,A,R,I,P,D,O);else if(R*P>0||I!=0)h(y.a,y.b,y.c,S,E,A,I,R,P,D,O);else if(R!=0)h(y.b,y.a,y.c,E,S,A,R,I,P,D,O);else if(P!=0)h(y.c,y.a,y.b,A,S,E,P,I,R,D,O);else return!0;return!1}function x(y,S,E,A){const _=S.degenerateSegment,b=y.plane.distanceToPoint(_.start),I=y.plane.distanceToPoint(_.end);return bn(b)?bn(I)?u(y,S,E,A):(E&&(E.start.copy(_.start),E.end.copy(_.start)),y.containsPoint(_.start)):bn(I)?(E&&(E.start.copy(_.end),E.end.copy(_.end)),y.containsPoint(_.end)):y.plane.intersectLine(_,i)!=null?(E&&(E.start.copy(i),E.end.copy(i)),y.containsPoint(i)):!1}function m(y,S,E){const A=S.a;return bn(y.plane.distanceToPoint(A))&&y.containsPoint(A)?(E&&(E.start.copy(A),E.end.copy(A)),!0):!1}function p(y,S,E){const A=y.degenerateSegment,_=S.a;return A.closestPointToPoint(_,!0,i),_.distanceToSquared(i)<ap?(E&&(E.start.copy(_),E.end.copy(_)),!0):!1}function v(y,S,E,A){if(y.isDegenerateIntoSegment)if(S.isDegenerateIntoSegment){const _=y.degenerateSegment,b=S.degenerateSegment,I=r,R=s;_.delta(I),b.delta(R);const P=i.subVectors(b.start,_.start),D=I.x*R.y-I.y*R.x;if(bn(D))return!1;const O=(P.x*R.y-P.y*R.x)/D,L=-(I.x*P.y-I.y*P.x)/D;if(O<0||O>1||L<0||L>1)return!1;const k=_.start.z+I.z*O,V=b.start.z+R.z*L;return bn(k-V)?(E&&(E.start.copy(_.start).addScaledVector(I,O),E.end.copy(_.start).addScaledVector(I,O)),!0):!1}else return S.isDegenerateIntoPoint?p(y,S,E):x(S,y,E,A);else{if(y.isDegenerateIntoPoint)return S.isDegenerateIntoPoint?S.a.distanceToSquared(y.a)<ap?(E&&(E.start.copy(y.a),E.end.copy(y.a)),!0):!1:S.isDegenerateIntoSegment?p(S,y,E):m(S,y,E);if(S.isDegenerateIntoPoint)return m(y,S,E);if(S.isDegenerateIntoSegment)return x(y,S,E,A)}}return function(S,E=null,A=!1){this.needsUpdate&&this.update(),S.isExtendedTriangle?S.needsUpdate&&S.update():(n.copy(S),n.update(),S=n);const _=v(this,S,E,A);if(_!==void 0)return _;const b=this.plane,I=S.plane;let R=I.distanceToPoint(this.a),P=I.distanceToPoint(this.b),D=I.distanceToPoint(this.c);bn(R)&&(R=0),bn(P)&&(P=0),bn(D)&&(D=0);const O=R*P,L=R*D;if(O>0&&L>0)return!1;let k=b.distanceToPoint(S.a),V=b.distanceToPoint(S.b),W=b.distanceToPoint(S.c);bn(k)&&(k=0),bn(V)&&(V=0),bn(W)&&(W=0);const te=k*V,X=k*W;if(te>0&&X>0)return!1;r.copy(b.normal),s.copy(I.normal);const j=r.cross(s);let ee=0,Se=Math.abs(j.x);const De=Math.abs(j.y);De>Se&&(Se=De,ee=1),Math.abs(j.z)>Se&&(ee=2);const fe=CM[ee],xe=this.a[fe],Ae=this.b[fe],ge=this.c[fe],Ie=S.a[fe],_t=S.b[fe],Re=S.c[fe];if(g(this,xe,Ae,ge,O,L,R,P,D,f,o))return u(this,S,E,A);if(g(S,Ie,_t,Re,te,X,k,V,W,d,l))return u(this,S,E,A);if(f.y<f.x){const Ke=f.y;f.y=f.x,f.x=Ke,c.copy(o.start),o.start.copy(o.end),o.end.copy(c)}if(d.y<d.x){const Ke=d.y;d.y=d.x,d.x=Ke,c.copy(l.start),l.start.copy(l.end),l.end.copy(c)}return f.y<d.x||d.y<f.x?!1:(E&&(d.x>f.x?E.start.copy(l.start):E.start.copy(o.start),d.y<f.y?E.end.copy(l.end):E.end.copy(o.end)),!0)}})(),kn.prototype.distanceToPoint=(function(){const n=new N;return function(t){return this.closestPointToPoint(t,n),t.distanceTo(n)}})(),kn.prototype.distanceToTriangle=(function(){const n=new N,e=new N,t=["a","b","c"],i=new bi,r=new bi;return function(a,o=null,l=null){const c=o||l?i:null;if(this.intersectsTriangle(a,c,!0))return(o||l)&&(o&&c.getCenter(o),l&&c.getCenter(l)),0;let f=1/0;for(let d=0;d<3;d++){let u;const h=t[d],g=a[h];this.closestPointToPoint(g,n),u=g.distanceToSquared(n),u<f&&(f=u,o&&o.copy(n),l&&l.copy(g));const x=this[h];a.closestPointToPoint(x,n),u=x.distanceToSquared(n),u<f&&(f=u,o&&o.copy(x),l&&l.copy(n))}for(let d=0;d<3;d++){const u=t[d],h=t[(d+1)%3];i.set(this[u],this[h]);for(let g=0;g<3;g++){const x=t[g],m=t[(g+1)%3];r.set(a[x],a[m]),Au(i,r,n,e);const p=n.distanceToSquared(e);p<f&&(f=p,o&&o.copy(n),l&&l.copy(e))}}return Math.sqrt(f)}})();class sn{constructor(e,t,i){this.isOrientedBox=!0,this.min=new N,this.max=new N,this.matrix=new tt,this.invMatrix=new tt,this.points=new Array(8).fill().map(()=>new N),this.satAxes=new Array(3).fill().map(()=>new N),this.satBounds=new Array(3).fill().map(()=>new Ei),this.alignedSatBounds=new Array(3).fill().map(()=>new Ei),this.needsUpdate=!1,e&&this.min.copy(e),t&&this.max.copy(t),i&&this.matrix.copy(i)}set(e,t,i){this.min.copy(e),this.max.copy(t),this.matrix.copy(i),this.needsUpdate=!0}copy(e){this.min.copy(e.min),this.max.copy(e.max),this.matrix.copy(e.matrix),this.needsUpdate=!0}}sn.prototype.update=(function(){return function(){const e=this.matrix,t=this.min,i=this.max,r=this.points;for(let c=0;c<=1;c++)for(let f=0;f<=1;f++)for(let d=0;d<=1;d++){const u=1*c|2*f|4*d,h=r[u];h.x=c?i.x:t.x,h.y=f?i.y:t.y,h.z=d?i.z:t.z,h.applyMatrix4(e)}const s=this.satBounds,a=this.satAxes,o=r[0];for(let c=0;c<3;c++){const f=a[c],d=s[c],u=1<<c,h=r[u];f.subVectors(o,h),d.setFromPoints(f,r)}const l=this.alignedSatBounds;l[0].setFromPointsField(r,"x"),l[1].setFromPointsField(r,"y"),l[2].setFromPointsField(r,"z"),this.invMatrix.copy(this.matrix).invert(),this.needsUpdate=!1}})(),sn.prototype.intersectsBox=(function(){const n=new Ei;return function(t){this.needsUpdate&&this.update();const i=t.min,r=t.max,s=this.satBounds,a=this.satAxes,o=this.alignedSatBounds;if(n.min=i.x,n.max=r.x,o[0].isSeparated(n)||(n.min=i.y,n.max=r.y,o[1].isSeparated(n))||(n.min=i.z,n.max=r.z,o[2].isSeparated(n)))return!1;for(let l=0;l<3;l++){const c=a[l],f=s[l];if(n.setFromBox(c,t),f.isSeparated(n))return!1}return!0}})(),sn.prototype.intersectsTriangle=(function(){const n=new kn,e=new Array(3),t=new Ei,i=new Ei,r=new N;return function(a){this.needsUpdate&&this.update(),a.isExtendedTriangle?a.needsUpdate&&a.update():(n.copy(a),n.update(),a=n);const o=this.satBounds,l=this.satAxes;e[0]=a.a,e[1]=a.b,e[2]=a.c;for(let u=0;u<3;u++){const h=o[u],g=l[u];if(t.setFromPoints(g,e),h.isSeparated(t))return!1}const c=a.satBounds,f=a.satAxes,d=this.points;for(let u=0;u<3;u++){const h=c[u],g=f[u];if(t.setFromPoints(g,d),h.isSeparated(t))return!1}for(let u=0;u<3;u++){const h=l[u];for(let g=0;g<4;g++){const x=f[g];if(r.crossVectors(h,x),t.setFromPoints(r,e),i.setFromPoints(r,d),t.isSeparated(i))return!1}}return!0}})(),sn.prototype.closestPointToPoint=(function(){return function(e,t){return this.needsUpdate&&this.update(),t.copy(e).applyMatrix4(this.invMatrix).clamp(this.min,this.max).applyMatrix4(this.matrix),t}})(),sn.prototype.distanceToPoint=(function(){const n=new N;return function(t){return this.closestPointToPoint(t,n),t.distanceTo(n)}})(),sn.prototype.distanceToBox=(function(){const n=["x","y","z"],e=new Array(12).fill().map(()=>new bi),t=new Array(12).fill().map(()=>new bi),i=new N,r=new N;return function(a,o=0,l=null,c=null){if(this.needsUpdate&&this.update(),this.intersectsBox(a))return(l||c)&&(a.getCenter(r),this.closestPointToPoint(r,i),a.closestPointToPoint(i,r),l&&l.copy(i),c&&c.copy(r)),0;const f=o*o,d=a.min,u=a.max,h=this.points;let g=1/0;for(let m=0;m<8;m++){const p=h[m];r.copy(p).clamp(d,u);const v=p.distanceToSquared(r);if(v<g&&(g=v,l&&l.copy(p),c&&c.copy(r),v<f))return Math.sqrt(v)}let x=0;for(let m=0;m<3;m++)for(let p=0;p<=1;p++)for(let v=0;v<=1;v++){const y=(m+1)%3,S=(m+2)%3,E=p<<y|v<<S,A=1<<m|p<<y|v<<S,_=h[E],b=h[A];e[x].set(_,b);const R=n[m],P=n[y],D=n[S],O=t[x],L=O.start,k=O.end;L[R]=d[R],L[P]=p?d[P]:u[P],L[D]=v?d[D]:u[D],k[R]=u[R],k[P]=p?d[P]:u[P],k[D]=v?d[D]:u[D],x++}for(let m=0;m<=1;m++)for(let p=0;p<=1;p++)for(let v=0;v<=1;v++){r.x=m?u.x:d.x,r.y=p?u.y:d.y,r.z=v?u.z:d.z,this.closestPointToPoint(r,i);const y=r.distanceToSquared(i);if(y<g&&(g=y,l&&l.copy(i),c&&c.copy(r),y<f))return Math.sqrt(y)}for(let m=0;m<12;m++){const p=e[m];for(let v=0;v<12;v++){const y=t[v];Au(p,y,i,r);const S=i.distanceToSquared(r);if(S<g&&(g=S,l&&l.copy(i),c&&c.copy(r),S<f))return Math.sqrt(S)}}return Math.sqrt(g)}})();class PM extends Su{constructor(){super(()=>new kn)}}const En=new PM,ta=new N,Ru=new N;function LM(n,e,t={},i=0,r=1/0){const s=i*i,a=r*r;let o=1/0,l=null;if(n.shapecast({boundsTraverseOrder:f=>(ta.copy(e).clamp(f.min,f.max),ta.distanceToSquared(e)),intersectsBounds:(f,d,u)=>u<o&&u<a,intersectsTriangle:(f,d)=>{f.closestPointToPoint(e,ta);const u=e.distanceToSquared(ta);return u<o&&(Ru.copy(ta),o=u,l=d),u<s}}),o===1/0)return null;const c=Math.sqrt(o);return t.point?t.point.copy(Ru):t.point=Ru.clone(),t.distance=c,t.faceIndex=l,t}const No=parseInt(Os)>=169,DM=parseInt(Os)<=161,Sr=new N,Mr=new N,yr=new N,Uo=new We,Fo=new We,Oo=new We,op=new N,lp=new N,cp=new N,na=new N;function IM(n,e,t,i,r,s,a,o){let l;if(s===en?l=n.intersectTriangle(i,t,e,!0,r):l=n.intersectTriangle(e,t,i,s!==un,r),l===null)return null;const c=n.origin.distanceTo(r);return c<a||c>o?null:{distance:c,point:r.clone()}}function up(n,e,t,i,r,s,a,o,l,c,f){Sr.fromBufferAttribute(e,s),Mr.fromBufferAttribute(e,a),yr.fromBufferAttribute(e,o);const d=IM(n,Sr,Mr,yr,na,l,c,f);if(d){if(i){Uo.fromBufferAttribute(i,s),Fo.fromBufferAttribute(i,a),Oo.fromBufferAttribute(i,o),d.uv=new We;const h=zt.getInterpolation(na,Sr,Mr,yr,Uo,Fo,Oo,d.uv);No||(d.uv=h)}if(r){Uo.fromBufferAttribute(r,s),Fo.fromBufferAttribute(r,a),Oo.fromBufferAttribute(r,o),d.uv1=new We;const h=zt.getInterpolation(na,Sr,Mr,yr,Uo,Fo,Oo,d.uv1);No||(d.uv1=h),DM&&(d.uv2=d.uv1)}if(t){op.fromBufferAttribute(t,s),lp.fromBufferAttribute(t,a),cp.fromBufferAttribute(t,o),d.normal=new N;const h=zt.getInterpolation(na,Sr,Mr,yr,op,lp,cp,d.normal);d.normal.dot(n.direction)>0&&d.normal.multiplyScalar(-1),No||(d.normal=h)}const u={a:s,b:a,c:o,normal:new N,materialIndex:0};if(zt.getNormal(Sr,Mr,yr,u.normal),d.face=u,d.faceIndex=s,No){const h=new N;zt.getBarycoord(na,Sr,Mr,yr,h),d.barycoord=h}}return d}function fp(n){return n&&n.isMaterial?n.side:n}function Bo(n,e,t,i,r,s,a){const o=i*3;let l=o+0,c=o+1,f=o+2;const{index:d,groups:u}=n;n.index&&(l=d.getX(l),c=d.getX(c),f=d.getX(f));const{position:h,normal:g,uv:x,uv1:m}=n.attributes;if(Array.isArray(e)){const p=i*3;for(let v=0,y=u.length;v<y;v++){const{start:S,count:E,materialIndex:A}=u[v];if(p>=S&&p<S+E){const _=fp(e[A]),b=up(t,h,g,x,m,l,c,f,_,s,a);if(b)if(b.faceIndex=i,b.face.materialIndex=A,r)r.push(b);else return b}}}else{const p=fp(e),v=up(t,h,g,x,m,l,c,f,p,s,a);if(v)if(v.faceIndex=i,v.face.materialIndex=0,r)r.push(v);else return v}return null}function bt(n,e,t,i){const r=n.a,s=n.b,a=n.c;let o=e,l=e+1,c=e+2;t&&(o=t.getX(o),l=t.getX(l),c=t.getX(c)),r.x=i.getX(o),r.y=i.getY(o),r.z=i.getZ(o),s.x=i.getX(l),s.y=i.getY(l),s.z=i.getZ(l),a.x=i.getX(c),a.y=i.getY(c),a.z=i.getZ(c)}function NM(n,e,t,i,r,s,a,o){const{geometry:l,_indirectBuffer:c}=n;for(let f=i,d=i+r;f<d;f++)Bo(l,e,t,f,s,a,o)}function UM(n,e,t,i,r,s,a){const{geometry:o,_indirectBuffer:l}=n;let c=1/0,f=null;for(let d=i,u=i+r;d<u;d++){let h;h=Bo(o,e,t,d,null,s,a),h&&h.distance<c&&(f=h,c=h.distance)}return f}function FM(n,e,t,i,r,s,a){const{geometry:o}=t,{index:l}=o,c=o.attributes.position;for(let f=n,d=e+n;f<d;f++){let u;if(u=f,bt(a,u*3,l,c),a.needsUpdate=!0,i(a,u,r,s))return!0}return!1}function OM(n,e=null){e&&Array.isArray(e)&&(e=new Set(e));const t=n.geometry,i=t.index?t.index.array:null,r=t.attributes.position;let s,a,o,l,c=0;const f=n._roots;for(let u=0,h=f.length;u<h;u++)s=f[u],a=new Uint32Array(s),o=new Uint16Array(s),l=new Float32Array(s),d(0,c),c+=s.byteLength;function d(u,h,g=!1){const x=u*2;if(xt(x,o)){const m=Nt(u,a),p=qt(x,o);let v=1/0,y=1/0,S=1/0,E=-1/0,A=-1/0,_=-1/0;for(let b=3*m,I=3*(m+p);b<I;b++){let R=i[b];const P=r.getX(R),D=r.getY(R),O=r.getZ(R);P<v&&(v=P),P>E&&(E=P),D<y&&(y=D),D>A&&(A=D),O<S&&(S=O),O>_&&(_=O)}return l[u+0]!==v||l[u+1]!==y||l[u+2]!==S||l[u+3]!==E||l[u+4]!==A||l[u+5]!==_?(l[u+0]=v,l[u+1]=y,l[u+2]=S,l[u+3]=E,l[u+4]=A,l[u+5]=_,!0):!1}else{const m=Rt(u),p=Ct(u,a);let v=g,y=!1,S=!1;if(e){if(!v){const R=m/yt+h/hn,P=p/yt+h/hn;y=e.has(R),S=e.has(P),v=!y&&!S}}else y=!0,S=!0;const E=v||y,A=v||S;let _=!1;E&&(_=d(m,h,v));let b=!1;A&&(b=d(p,h,v));const I=_||b;if(I)for(let R=0;R<3;R++){const P=m+R,D=p+R,O=l[P],L=l[P+3],k=l[D],V=l[D+3];l[u+R]=O<k?O:k,l[u+R+3]=L>V?L:V}return I}}}function wn(n,e,t,i,r){let s,a,o,l,c,f;const d=1/t.direction.x,u=1/t.direction.y,h=1/t.direction.z,g=t.origin.x,x=t.origin.y,m=t.origin.z;let p=e[n],v=e[n+3],y=e[n+1],S=e[n+3+1],E=e[n+2],A=e[n+3+2];return d>=0?(s=(p-g)*d,a=(v-g)*d):(s=(v-g)*d,a=(p-g)*d),u>=0?(o=(y-x)*u,l=(S-x)*u):(o=(S-x)*u,l=(y-x)*u),s>l||o>a||((o>s||isNaN(s))&&(s=o),(l<a||isNaN(a))&&(a=l),h>=0?(c=(E-m)*h,f=(A-m)*h):(c=(A-m)*h,f=(E-m)*h),s>f||c>a)?!1:((c>s||s!==s)&&(s=c),(f<a||a!==a)&&(a=f),s<=r&&a>=i)}function BM(n,e,t,i,r,s,a,o){const{geometry:l,_indirectBuffer:c}=n;for(let f=i,d=i+r;f<d;f++){let u=c?c[f]:f;Bo(l,e,t,u,s,a,o)}}function kM(n,e,t,i,r,s,a){const{geometry:o,_indirectBuffer:l}=n;let c=1/0,f=null;for(let d=i,u=i+r;d<u;d++){let h;h=Bo(o,e,t,l?l[d]:d,null,s,a),h&&h.distance<c&&(f=h,c=h.distance)}return f}function zM(n,e,t,i,r,s,a){const{geometry:o}=t,{index:l}=o,c=o.attributes.position;for(let f=n,d=e+n;f<d;f++){let u;if(u=t.resolveTriangleIndex(f),bt(a,u*3,l,c),a.needsUpdate=!0,i(a,u,r,s))return!0}return!1}function HM(n,e,t,i,r,s,a){it.setBuffer(n._roots[e]),wn(0,it.float32Array,i,s,a)&&Cu(0,n,t,i,r,s,a),it.clearBuffer()}function Cu(n,e,t,i,r,s,a){const{float32Array:o,uint16Array:l,uint32Array:c}=it,f=n*2;if(xt(f,l)){const u=Nt(n,c),h=qt(f,l);NM(e,t,i,u,h,r,s,a)}else{const u=Rt(n);wn(u,o,i,s,a)&&Cu(u,e,t,i,r,s,a);const h=Ct(n,c);wn(h,o,i,s,a)&&Cu(h,e,t,i,r,s,a)}}const GM=["x","y","z"];function VM(n,e,t,i,r,s){it.setBuffer(n._roots[e]);let a=null;return wn(0,it.float32Array,i,r,s)&&(a=Pu(0,n,t,i,r,s)),it.clearBuffer(),a}function Pu(n,e,t,i,r,s){const{float32Array:a,uint16Array:o,uint32Array:l}=it;let c=n*2;if(xt(c,o)){const d=Nt(n,l),u=qt(c,o);return UM(e,t,i,d,u,r,s)}else{const d=gu(n,l),u=GM[d],g=i.direction[u]>=0;let x,m;g?(x=Rt(n),m=Ct(n,l)):(x=Ct(n,l),m=Rt(n));const v=wn(x,a,i,r,s)?Pu(x,e,t,i,r,s):null;if(v){const E=v.point[u];if(g?E<=a[m+d]:E>=a[m+d+3])return v}const S=wn(m,a,i,r,s)?Pu(m,e,t,i,r,s):null;return v&&S?v.distance<=S.distance?v:S:v||S||null}}const ko=new nn,gs=new kn,_s=new kn,ia=new tt,dp=new sn,zo=new sn;function WM(n,e,t,i){it.setBuffer(n._roots[e]);const r=Lu(0,n,t,i);return it.clearBuffer(),r}function Lu(n,e,t,i,r=null){const{float32Array:s,uint16Array:a,uint32Array:o}=it;let l=n*2;if(r===null&&(t.boundingBox||t.computeBoundingBox(),dp.set(t.boundingBox.min,t.boundingBox.max,i),r=dp),xt(l,a)){const f=e.geometry,d=f.index,u=f.attributes.position,h=t.index,g=t.attributes.position,x=Nt(n,o),m=qt(l,a);if(ia.copy(i).invert(),t.boundsTree)return gt(n,s,zo),zo.matrix.copy(ia),zo.needsUpdate=!0,t.boundsTree.shapecast({intersectsBounds:v=>zo.intersectsBox(v),intersectsTriangle:v=>{v.a.applyMatrix4(i),v.b.applyMatrix4(i),v.c.applyMatrix4(i),v.needsUpdate=!0;for(let y=x*3,S=(m+x)*3;y<S;y+=3)if(bt(_s,y,d,u),_s.needsUpdate=!0,v.intersectsTriangle(_s))return!0;return!1}});{const p=Io(t);for(let v=x*3,y=(m+x)*3;v<y;v+=3){bt(gs,v,d,u),gs.a.applyMatrix4(ia),gs.b.applyMatrix4(ia),gs.c.applyMatrix4(ia),gs.needsUpdate=!0;for(let S=0,E=p*3;S<E;S+=3)if(bt(_s,S,h,g),_s.needsUpdate=!0,gs.intersectsTriangle(_s))return!0}}}else{const f=Rt(n),d=Ct(n,o);return gt(f,s,ko),!!(r.intersectsBox(ko)&&Lu(f,e,t,i,r)||(gt(d,s,ko),r.intersectsBox(ko)&&Lu(d,e,t,i,r)))}}const Ho=new tt,Du=new sn,ra=new sn,$M=new N,XM=new N,qM=new N,YM=new N;function KM(n,e,t,i={},r={},s=0,a=1/0){e.boundingBox||e.computeBoundingBox(),Du.set(e.boundingBox.min,e.boundingBox.max,t),Du.needsUpdate=!0;const o=n.geometry,l=o.attributes.position,c=o.index,f=e.attributes.position,d=e.index,u=En.getPrimitive(),h=En.getPrimitive();let g=$M,x=XM,m=null,p=null;r&&(m=qM,p=YM);let v=1/0,y=null,S=null;return Ho.copy(t).invert(),ra.matrix.copy(Ho),n.shapecast({boundsTraverseOrder:E=>Du.distanceToBox(E),intersectsBounds:(E,A,_)=>_<v&&_<a?(A&&(ra.min.copy(E.min),ra.max.copy(E.max),ra.needsUpdate=!0),!0):!1,intersectsRange:(E,A)=>{if(e.boundsTree)return e.boundsTree.shapecast({boundsTraverseOrder:b=>ra.distanceToBox(b),intersectsBounds:(b,I,R)=>R<v&&R<a,intersectsRange:(b,I)=>{for(let R=b,P=b+I;R<P;R++){bt(h,3*R,d,f),h.a.applyMatrix4(t),h.b.applyMatrix4(t),h.c.applyMatrix4(t),h.needsUpdate=!0;for(let D=E,O=E+A;D<O;D++){bt(u,3*D,c,l),u.needsUpdate=!0;const L=u.distanceToTriangle(h,g,m);if(L<v&&(x.copy(g),p&&p.copy(m),v=L,y=D,S=R),L<s)return!0}}}});{const _=Io(e);for(let b=0,I=_;b<I;b++){bt(h,3*b,d,f),h.a.applyMatrix4(t),h.b.applyMatrix4(t),h.c.applyMatrix4(t),h.needsUpdate=!0;for(let R=E,P=E+A;R<P;R++){bt(u,3*R,c,l),u.needsUpdate=!0;const D=u.distanceToTriangle(h,g,m);if(D<v&&(x.copy(g),p&&p.copy(m),v=D,y=R,S=b),D<s)return!0}}}}}),En.releasePrimitive(u),En.releasePrimitive(h),v===1/0?null:(i.point?i.point.copy(x):i.point=x.clone(),i.distance=v,i.faceIndex=y,r&&(r.point?r.point.copy(p):r.point=p.clone(),r.point.applyMatrix4(Ho),x.applyMatrix4(Ho),r.distance=x.sub(r.point).length(),r.faceIndex=S),i)}function ZM(n,e=null){e&&Array.isArray(e)&&(e=new Set(e));const t=n.geometry,i=t.index?t.index.array:null,r=t.attributes.position;let s,a,o,l,c=0;const f=n._roots;for(let u=0,h=f.length;u<h;u++)s=f[u],a=new Uint32Array(s),o=new Uint16Array(s),l=new Float32Array(s),d(0,c),c+=s.byteLength;function d(u,h,g=!1){const x=u*2;if(xt(x,o)){const m=Nt(u,a),p=qt(x,o);let v=1/0,y=1/0,S=1/0,E=-1/0,A=-1/0,_=-1/0;for(let b=m,I=m+p;b<I;b++){const R=3*n.resolveTriangleIndex(b);for(let P=0;P<3;P++){let D=R+P;D=i?i[D]:D;const O=r.getX(D),L=r.getY(D),k=r.getZ(D);O<v&&(v=O),O>E&&(E=O),L<y&&(y=L),L>A&&(A=L),k<S&&(S=k),k>_&&(_=k)}}return l[u+0]!==v||l[u+1]!==y||l[u+2]!==S||l[u+3]!==E||l[u+4]!==A||l[u+5]!==_?(l[u+0]=v,l[u+1]=y,l[u+2]=S,l[u+3]=E,l[u+4]=A,l[u+5]=_,!0):!1}else{const m=Rt(u),p=Ct(u,a);let v=g,y=!1,S=!1;if(e){if(!v){const R=m/yt+h/hn,P=p/yt+h/hn;y=e.has(R),S=e.has(P),v=!y&&!S}}else y=!0,S=!0;const E=v||y,A=v||S;let _=!1;E&&(_=d(m,h,v));let b=!1;A&&(b=d(p,h,v));const I=_||b;if(I)for(let R=0;R<3;R++){const P=m+R,D=p+R,O=l[P],L=l[P+3],k=l[D],V=l[D+3];l[u+R]=O<k?O:k,l[u+R+3]=L>V?L:V}return I}}}function JM(n,e,t,i,r,s,a){it.setBuffer(n._roots[e]),wn(0,it.float32Array,i,s,a)&&Iu(0,n,t,i,r,s,a),it.clearBuffer()}function Iu(n,e,t,i,r,s,a){const{float32Array:o,uint16Array:l,uint32Array:c}=it,f=n*2;if(xt(f,l)){const u=Nt(n,c),h=qt(f,l);BM(e,t,i,u,h,r,s,a)}else{const u=Rt(n);wn(u,o,i,s,a)&&Iu(u,e,t,i,r,s,a);const h=Ct(n,c);wn(h,o,i,s,a)&&Iu(h,e,t,i,r,s,a)}}const QM=["x","y","z"];function jM(n,e,t,i,r,s){it.setBuffer(n._roots[e]);let a=null;return wn(0,it.float32Array,i,r,s)&&(a=Nu(0,n,t,i,r,s)),it.clearBuffer(),a}function Nu(n,e,t,i,r,s){const{float32Array:a,uint16Array:o,uint32Array:l}=it;let c=n*2;if(xt(c,o)){const d=Nt(n,l),u=qt(c,o);return kM(e,t,i,d,u,r,s)}else{const d=gu(n,l),u=QM[d],g=i.direction[u]>=0;let x,m;g?(x=Rt(n),m=Ct(n,l)):(x=Ct(n,l),m=Rt(n));const v=wn(x,a,i,r,s)?Nu(x,e,t,i,r,s):null;if(v){const E=v.point[u];if(g?E<=a[m+d]:E>=a[m+d+3])return v}const S=wn(m,a,i,r,s)?Nu(m,e,t,i,r,s):null;return v&&S?v.distance<=S.distance?v:S:v||S||null}}const Go=new nn,vs=new kn,xs=new kn,sa=new tt,hp=new sn,Vo=new sn;function ey(n,e,t,i){it.setBuffer(n._roots[e]);const r=Uu(0,n,t,i);return it.clearBuffer(),r}function Uu(n,e,t,i,r=null){const{float32Array:s,uint16Array:a,uint32Array:o}=it;let l=n*2;if(r===null&&(t.boundingBox||t.computeBoundingBox(),hp.set(t.boundingBox.min,t.boundingBox.max,i),r=hp),xt(l,a)){const f=e.geometry,d=f.index,u=f.attributes.position,h=t.index,g=t.attributes.position,x=Nt(n,o),m=qt(l,a);if(sa.copy(i).invert(),t.boundsTree)return gt(n,s,Vo),Vo.matrix.copy(sa),Vo.needsUpdate=!0,t.boundsTree.shapecast({intersectsBounds:v=>Vo.intersectsBox(v),intersectsTriangle:v=>{v.a.applyMatrix4(i),v.b.applyMatrix4(i),v.c.applyMatrix4(i),v.needsUpdate=!0;for(let y=x,S=m+x;y<S;y++)if(bt(xs,3*e.resolveTriangleIndex(y),d,u),xs.needsUpdate=!0,v.intersectsTriangle(xs))return!0;return!1}});{const p=Io(t);for(let v=x,y=m+x;v<y;v++){const S=e.resolveTriangleIndex(v);bt(vs,3*S,d,u),vs.a.applyMatrix4(sa),vs.b.applyMatrix4(sa),vs.c.applyMatrix4(sa),vs.needsUpdate=!0;for(let E=0,A=p*3;E<A;E+=3)if(bt(xs,E,h,g),xs.needsUpdate=!0,vs.intersectsTriangle(xs))return!0}}}else{const f=Rt(n),d=Ct(n,o);return gt(f,s,Go),!!(r.intersectsBox(Go)&&Uu(f,e,t,i,r)||(gt(d,s,Go),r.intersectsBox(Go)&&Uu(d,e,t,i,r)))}}const Wo=new tt,Fu=new sn,aa=new sn,ty=new N,ny=new N,iy=new N,ry=new N;function sy(n,e,t,i={},r={},s=0,a=1/0){e.boundingBox||e.computeBoundingBox(),Fu.set(e.boundingBox.min,e.boundingBox.max,t),Fu.needsUpdate=!0;const o=n.geometry,l=o.attributes.position,c=o.index,f=e.attributes.position,d=e.index,u=En.getPrimitive(),h=En.getPrimitive();let g=ty,x=ny,m=null,p=null;r&&(m=iy,p=ry);let v=1/0,y=null,S=null;return Wo.copy(t).invert(),aa.matrix.copy(Wo),n.shapecast({boundsTraverseOrder:E=>Fu.distanceToBox(E),intersectsBounds:(E,A,_)=>_<v&&_<a?(A&&(aa.min.copy(E.min),aa.max.copy(E.max),aa.needsUpdate=!0),!0):!1,intersectsRange:(E,A)=>{if(e.boundsTree){const _=e.boundsTree;return _.shapecast({boundsTraverseOrder:b=>aa.distanceToBox(b),intersectsBounds:(b,I,R)=>R<v&&R<a,intersectsRange:(b,I)=>{for(let R=b,P=b+I;R<P;R++){const D=_.resolveTriangleIndex(R);bt(h,3*D,d,f),h.a.applyMatrix4(t),h.b.applyMatrix4(t),h.c.applyMatrix4(t),h.needsUpdate=!0;for(let O=E,L=E+A;O<L;O++){const k=n.resolveTriangleIndex(O);bt(u,3*k,c,l),u.needsUpdate=!0;const V=u.distanceToTriangle(h,g,m);if(V<v&&(x.copy(g),p&&p.copy(m),v=V,y=O,S=R),V<s)return!0}}}})}else{const _=Io(e);for(let b=0,I=_;b<I;b++){bt(h,3*b,d,f),h.a.applyMatrix4(t),h.b.applyMatrix4(t),h.c.applyMatrix4(t),h.needsUpdate=!0;for(let R=E,P=E+A;R<P;R++){const D=n.resolveTriangleIndex(R);bt(u,3*D,c,l),u.needsUpdate=!0;const O=u.distanceToTriangle(h,g,m);if(O<v&&(x.copy(g),p&&p.copy(m),v=O,y=R,S=b),O<s)return!0}}}}}),En.releasePrimitive(u),En.releasePrimitive(h),v===1/0?null:(i.point?i.point.copy(x):i.point=x.clone(),i.distance=v,i.faceIndex=y,r&&(r.point?r.point.copy(p):r.point=p.clone(),r.point.applyMatrix4(Wo),x.applyMatrix4(Wo),r.distance=x.sub(r.point).length(),r.faceIndex=S),i)}function pp(n,e,t){return n===null?null:(n.point.applyMatrix4(e.matrixWorld),n.distance=n.point.distanceTo(t.ray.origin),n.object=e,n)}const $o=new sn,Xo=new io,mp=new N,gp=new tt,_p=new N,Ou=["getX","getY","getZ"];class qo extends TM{static serialize(e,t={}){t={cloneBuffers:!0,...t};const i=e.geometry,r=e._roots,s=e._indirectBuffer,a=i.getIndex(),o={version:1,roots:null,index:null,indirectBuffer:null};return t.cloneBuffers?(o.roots=r.map(l=>l.slice()),o.index=a?a.array.slice():null,o.indirectBuffer=s?s.slice():null):(o.roots=r,o.index=a?a.array:null,o.indirectBuffer=s),o}static deserialize(e,t,i={}){i={setIndex:!0,indirect:!!e.indirectBuffer,...i};const{index:r,roots:s,indirectBuffer:a}=e;e.version||(console.warn("MeshBVH.deserialize: Serialization format has been changed and will be fixed up. It is recommended to regenerate any stored serialized data."),l(s));const o=new qo(t,{...i,[hu]:!0});if(o._roots=s,o._indirectBuffer=a||null,i.setIndex){const c=t.getIndex();if(c===null){const f=new Ht(e.index,1,!1);t.setIndex(f)}else c.array!==r&&(c.array.set(r),c.needsUpdate=!0)}return o;function l(c){for(let f=0;f<c.length;f++){const d=c[f],u=new Uint32Array(d),h=new Uint16Array(d);for(let g=0,x=d.byteLength/hn;g<x;g++){const m=yt*g,p=2*m;xt(p,h)||(u[m+6]=u[m+6]/yt-g)}}}}get primitiveStride(){return 3}get resolveTriangleIndex(){return this.resolvePrimitiveIndex}constructor(e,t={}){t.maxLeafTris&&(console.warn('MeshBVH: "maxLeafTris" option has been deprecated. Use "targetLeafSize", instead.'),t={...t,targetLeafSize:t.maxLeafTris}),super(e,t)}shiftTriangleOffsets(e){return super.shiftPrimitiveOffsets(e)}writePrimitiveBounds(e,t,i){const r=this.geometry,s=this._indirectBuffer,a=r.attributes.position,o=r.index?r.index.array:null,c=(s?s[e]:e)*3;let f=c+0,d=c+1,u=c+2;o&&(f=o[f],d=o[d],u=o[u]);for(let h=0;h<3;h++){const g=a[Ou[h]](f),x=a[Ou[h]](d),m=a[Ou[h]](u);let p=g;x<p&&(p=x),m<p&&(p=m);let v=g;x>v&&(v=x),m>v&&(v=m),t[i+h]=p,t[i+h+3]=v}return t}computePrimitiveBounds(e,t,i){const r=this.geometry,s=this._indirectBuffer,a=r.attributes.position,o=r.index?r.index.array:null,l=a.normalized;if(e<0||t+e-i.offset>i.length/6)throw new Error("MeshBVH: compute triangle bounds range is invalid.");const c=a.array,f=a.offset||0;let d=3;a.isInterleavedBufferAttribute&&(d=a.data.stride);const u=["getX","getY","getZ"],h=i.offset;for(let g=e,x=e+t;g<x;g++){const p=(s?s[g]:g)*3,v=(g-h)*6;let y=p+0,S=p+1,E=p+2;o&&(y=o[y],S=o[S],E=o[E]),l||(y=y*d+f,S=S*d+f,E=E*d+f);for(let A=0;A<3;A++){let _,b,I;l?(_=a[u[A]](y),b=a[u[A]](S),I=a[u[A]](E)):(_=c[y+A],b=c[S+A],I=c[E+A]);let R=_;b<R&&(R=b),I<R&&(R=I);let P=_;b>P&&(P=b),I>P&&(P=I);const D=(P-R)/2,O=A*2;i[v+O+0]=R+D,i[v+O+1]=D+(Math.abs(R)+D)*Ro}}return i}raycastObject3D(e,t,i=[]){const{material:r}=e;if(r===void 0)return;gp.copy(e.matrixWorld).invert(),Xo.copy(t.ray).applyMatrix4(gp),_p.setFromMatrixScale(e.matrixWorld),mp.copy(Xo.direction).multiply(_p);const s=mp.length(),a=t.near/s,o=t.far/s;if(t.firstHitOnly===!0){let l=this.raycastFirst(Xo,r,a,o);l=pp(l,e,t),l&&i.push(l)}else{const l=this.raycast(Xo,r,a,o);for(let c=0,f=l.length;c<f;c++){const d=pp(l[c],e,t);d&&i.push(d)}}return i}refit(e=null){return(this.indirect?ZM:OM)(this,e)}raycast(e,t=hi,i=0,r=1/0){const s=this._roots,a=[],o=this.indirect?JM:HM;for(let l=0,c=s.length;l<c;l++)o(this,l,t,e,a,i,r);return a}raycastFirst(e,t=hi,i=0,r=1/0){const s=this._roots;let a=null;const o=this.indirect?jM:VM;for(let l=0,c=s.length;l<c;l++){const f=o(this,l,t,e,i,r);f!=null&&(a==null||f.distance<a.distance)&&(a=f)}return a}intersectsGeometry(e,t){let i=!1;const r=this._roots,s=this.indirect?ey:WM;for(let a=0,o=r.length;a<o&&(i=s(this,a,e,t),!i);a++);return i}shapecast(e){const t=En.getPrimitive(),i=super.shapecast({...e,intersectsPrimitive:e.intersectsTriangle,scratchPrimitive:t,iterate:this.indirect?zM:FM});return En.releasePrimitive(t),i}bvhcast(e,t,i){let{intersectsRanges:r,intersectsTriangles:s}=i;const a=En.getPrimitive(),o=this.geometry.index,l=this.geometry.attributes.position,c=this.indirect?g=>{const x=this.resolveTriangleIndex(g);bt(a,x*3,o,l)}:g=>{bt(a,g*3,o,l)},f=En.getPrimitive(),d=e.geometry.index,u=e.geometry.attributes.position,h=e.indirect?g=>{const x=e.resolveTriangleIndex(g);bt(f,x*3,d,u)}:g=>{bt(f,g*3,d,u)};if(s){if(!(e instanceof qo))throw new Error('MeshBVH: "intersectsTriangles" callback can only be used with another MeshBVH.');const g=(x,m,p,v,y,S,E,A)=>{for(let _=p,b=p+v;_<b;_++){h(_),f.a.applyMatrix4(t),f.b.applyMatrix4(t),f.c.applyMatrix4(t),f.needsUpdate=!0;for(let I=x,R=x+m;I<R;I++)if(c(I),a.needsUpdate=!0,s(a,f,I,_,y,S,E,A))return!0}return!1};if(r){const x=r;r=function(m,p,v,y,S,E,A,_){return x(m,p,v,y,S,E,A,_)?!0:g(m,p,v,y,S,E,A,_)}}else r=g}return super.bvhcast(e,t,{intersectsRanges:r})}intersectsBox(e,t){return $o.set(e.min,e.max,t),$o.needsUpdate=!0,this.shapecast({intersectsBounds:i=>$o.intersectsBox(i),intersectsTriangle:i=>$o.intersectsTriangle(i)})}intersectsSphere(e){return this.shapecast({intersectsBounds:t=>e.intersectsBox(t),intersectsTriangle:t=>t.intersectsSphere(e)})}closestPointToGeometry(e,t,i={},r={},s=0,a=1/0){return(this.indirect?sy:KM)(this,e,t,i,r,s,a)}closestPointToPoint(e,t={},i=0,r=1/0){return LM(this,e,t,i,r)}}class ay{constructor(e,t){this.mesh=e;const i=e.finding.length,r=new Float32Array(2*i);e.finding.forEach((s,a)=>{r[2*a]=s,r[2*a+1]=s<0?-1:t.get(s)??0}),this.geometry.setAttribute("position",new Ht(e.position,3)),this.geometry.setAttribute("normal",new Ht(e.normal,3)),this.geometry.setAttribute("tint",new Ht(e.color,4,!0)),this.geometry.setAttribute("support",new Ht(e.support,1,!0)),this.geometry.setAttribute("blade",new Ht(e.blade,1)),this.geometry.setAttribute("mark",new Ht(r,2)),this.geometry.setIndex(new Ht(e.index,1)),this.bvh=new qo(this.geometry),[this.center,this.radius]=oy(e.position)}mesh;geometry=new Xn;center;radius;bvh;ray=new io;cast(e,t){this.ray.origin.set(...e),this.ray.direction.set(...t);const i=this.bvh.raycastFirst(this.ray,un);if(!i?.face)return null;const{a:r,b:s,c:a}=i.face,[o,l,c]=[this.vertex(r),this.vertex(s),this.vertex(a)],f=l.clone().sub(o).cross(c.clone().sub(o)).normalize(),d=[r,s,a].reduce((u,h)=>this.vertex(h).distanceToSquared(i.point)<this.vertex(u).distanceToSquared(i.point)?h:u,r);return{point:i.point.toArray(),distance:i.distance,normal:f.toArray(),cosine:-f.dot(this.ray.direction),finding:this.mesh.finding[d],support:this.mesh.support[d]/255,vertex:d}}clear(e,t,i){this.ray.origin.set(...e);const r=new N(...t).sub(this.ray.origin),s=r.length();this.ray.direction.copy(r.divideScalar(s||1));const a=this.bvh.raycastFirst(this.ray,un);return!a||a.distance>=s-i}nearest(e){const t=this.bvh.closestPointToPoint(new N(...e));if(!t)return null;const i=this.mesh.index,[r,s,a]=[0,1,2].map(d=>i[3*t.faceIndex+d]),[o,l,c]=[this.vertex(r),this.vertex(s),this.vertex(a)],f=l.clone().sub(o).cross(c.sub(o)).normalize();return{point:t.point.toArray(),normal:f.toArray(),distance:t.distance,vertex:r}}vertex(e){return new N().fromArray(this.mesh.position,3*e)}}function oy(n){const e=n.length/3,t=Math.max(1,Math.floor(e/2e4)),i=[0,1,2].map(s=>{const a=[];for(let l=0;l<e;l+=t)a.push(n[3*l+s]);a.sort((l,c)=>l-c);const o=l=>a[Math.min(a.length-1,Math.floor(l*a.length))]??0;return(o(.02)+o(.98))/2}),r=[];for(let s=0;s<e;s+=t)r.push(Math.hypot(n[3*s]-i[0],n[3*s+1]-i[1],n[3*s+2]-i[2]));return r.sort((s,a)=>s-a),[i,r[Math.min(r.length-1,Math.floor(.98*r.length))]||1]}const ly={schema_version:Nl,title:"Inspection",model:{index:0,count:0,unit:"model",scale:null},models:[],videos:[],camera:null,frames:[],sprite:null,detections:[],defects:[],events:[],row:{status:"unknown"},verdict:"unknown",flags:[],surface:null,surface_reason:null,up:null},Ti=window.BLADEATLAS,Yo=Ti?Ti.viewer.schema_version!==Nl?`This page reads data of version ${Nl}; the data beside it has version ${String(Ti.viewer.schema_version)}.`:null:"The file data.js is not beside this page, or it could not be read. Open index.html in the folder that the inspection wrote.",Ko=!Ti?.forgets,re=Yo||!Ti?ly:Ti.viewer,Ki=_g([...re.defects.map(n=>n.label),...re.detections.map(n=>n.label)]),Bu=new Map(re.defects.map(n=>[n.id,n])),Zi=new Map(re.frames.map(n=>[n.index,n])),Ai=new Map(re.detections.map(n=>[n.id,n])),Ji=xp(re.detections,n=>n.frame),Zo=Mg(re.row),Jo=xp(re.events,n=>n.defect_id),Pt=[...re.frames].sort((n,e)=>n.video-e.video||n.time_s-e.time_s),Qi=new Map(Pt.map((n,e)=>[n.index,e]));let vp=null;const St=cy(),ku=St?null:vp??re.surface_reason??"The result has no surface.",Be={width:re.camera?.width??re.videos[0]?.width??960,height:re.camera?.height??re.videos[0]?.height??720},lt=new Eg(re.camera&&hg(re.camera.model,re.camera.params),re.camera?.crop??re.crop??[0,0,Be.width,Be.height],re.frames,St,re.surface?.spacing??0),br=uy();function cy(){if(!Ti?.surface||Yo)return null;try{const n=new Map(re.defects.map(t=>[t.id,Ki.get(t.label)?.index??0])),e=new ay(lg(ig(Ti.surface)),n);return Ti.surface=null,e}catch(n){return vp=`The surface could not be read: ${n instanceof Error?n.message:String(n)}.`,null}}function uy(){const n=[0],e=Math.max(re.videos.length,1+Math.max(0,...re.frames.map(t=>t.video)));for(let t=0;t<e;t++){const i=Math.max(0,...re.frames.filter(r=>r.video===t).map(r=>r.time_s));n.push(n[t]+Math.max(re.videos[t]?.duration_s??0,i))}return n}function xp(n,e){const t=new Map;for(const i of n){const r=e(i);if(r===null)continue;const s=t.get(r);s?s.push(i):t.set(r,[i])}return t}const zu=["picture","support","defect","blade"],Ss=["findings","frames","detections"],fy={tab:"findings",d:null,f:null,n:null,p:null,b:null,layer:"picture",cam:null};function Sp(n){const e=new URLSearchParams(n.replace(/^#/,"")),t=r=>{const s=e.get(r);return s!==null&&(r==="d"?/^-?\d{1,9}$/:/^\d{1,9}$/).test(s)?Number(s):null},i=(r,s)=>{const a=(e.get(r)??"").split(",").map(o=>o.trim()?Number(o):NaN);return a.length===s&&a.every(Number.isFinite)?a:null};return{tab:Ss.find(r=>r===e.get("tab"))??"findings",d:t("d"),f:t("f"),n:t("n"),p:i("p",3),b:t("b"),layer:zu.find(r=>r===e.get("layer"))??"picture",cam:i("cam",10)}}function Mp(n){const e=[];n.tab!=="findings"&&e.push(`tab=${n.tab}`);for(const t of["d","f","n","b"]){const i=n[t];i!==null&&e.push(`${t}=${i}`)}return n.p&&e.push(`p=${yp(n.p)}`),n.layer!=="picture"&&e.push(`layer=${n.layer}`),n.cam&&e.push(`cam=${yp(n.cam)}`),`#${e.join("&")}`}function yp(n){return n.map(e=>String(Number(e.toPrecision(6)))).join(",")}const dy={size:"Size",confidence:"Confidence",seen:"Persistence",blade:"Blade",label:"Label",time:"First seen",id:"Number"};function hy(n,e,t=new Map){const i=s=>{switch(n){case"size":return s.length??s.size;case"confidence":return s.confidence?.value??null;case"seen":return s.persistence.share;case"blade":return s.blade?Number(s.blade)||String(s.blade):null;case"label":return s.label;case"time":return py(t.get(s.id));case"id":return s.id}},r=e?-1:1;return(s,a)=>{const[o,l]=[i(s),i(a)];if(o===null||l===null)return o===l?s.id-a.id:o===null?1:-1;const c=typeof o=="number"&&typeof l=="number"?o-l:String(o).localeCompare(String(l));return r*c||s.id-a.id}}function py(n){return n?.length?Math.min(...n.map(e=>1e6*(e.video??0)+e.start_s)):null}const Pe=Ve(fy),Ms=Wt(()=>Pe.value.tab),Qo=Wt(()=>Pe.value.layer),Hu=Ve(new Map),jn=Wt(()=>[...re.defects,...Hu.value.values()]),oa=n=>Bu.get(n)??Hu.value.get(n),He=Wt(()=>Pe.value.d===null?null:oa(Pe.value.d)??null),Ri=Wt(()=>Pe.value.f===null?null:Zi.get(Pe.value.f)??null),ys=Wt(()=>Pe.value.n===null?null:Ai.get(Pe.value.n)??null),Er=Wt(()=>Pe.value.b),wr=Ve("outlines"),Tr=Ve(0),bs=Ve(!1),Gu=Ve(0),Ar=Ve(!1),Ci=Ve([]),ji=Ve(!1),Yt=Ve(null),ei=Ve(!1),pn=Ve(my()),Pi=Ve(null),Vu=Ve(null),ti=Ve(""),Wu=Ve("size"),la=Ve(!0),Rr=Ve({label:"",blade:"",confidence:"",review:"",words:""}),jo=Ve(!1),el=Wt(()=>{const n=Pe.value.p;if(n&&St){const t=St.nearest(n);return t?lt.visibleFrames(t.point,t.normal):[]}const e=He.value;return e?e.frames.map(({frame_index:t,quality:i})=>({frame:t,quality:i,x:NaN,y:NaN})):[]}),bp="bladeatlas-units";function my(){try{return localStorage.getItem(bp)==="in"?"in":"mm"}catch{return"mm"}}function gy(n){pn.value=n;try{localStorage.setItem(bp,n)}catch{}}function mn(n,e=!1){const t={...Pe.peek(),...n},i=Mp(t);Pe.value=t,i!==(location.hash||"#")&&(e?location.replace(i):location.hash=i)}function Li(n,e={}){const t=n===null?void 0:oa(n);Cs(()=>{if(Pi.value=null,!t)return mn({d:null,n:null,p:null});const i=Pe.peek().f,r=e.frame??ca(t.id)??i;mn({d:t.id,f:r,n:null,p:null,cam:null}),ti.value=`Finding ${wt(t.id)}, ${t.label}${r===null?"":`, frame ${r}`}`})}function ca(n){const e=oa(n);if(!e)return null;const t=e.frames.find(r=>r.detected)?.frame_index,i=e.detections.map(r=>Ai.get(r)?.frame).find(r=>r!=null);return e.best?.frame??e.best_frames[0]??t??i??e.frames[0]?.frame_index??null}function ni(n,e=!1){if(n===null||!Zi.has(n))return;const t=ys.peek();Cs(()=>{Pi.peek()?.frame!==n&&(Pi.value=null),mn({f:n,n:t?.frame===n?t.id:null},e)})}function $u(n){const e=Ai.get(n);if(!e)return;Pi.value=null;const t=e.defect!==null&&Bu.has(e.defect);mn({n,d:t?e.defect:null,f:e.frame??Pe.peek().f,p:null}),ti.value=`Detection ${n}, ${e.label}, ${e.state}`}function Ep(n,e,t){Cs(()=>{const i=Bu.has(e),r=t===void 0&&St?St.nearest(n):null,s=Pe.peek().f,a=r?lt.visibleFrames(r.point,r.normal):[],o=t??(i?ca(e):a.some(l=>l.frame===s)?s:a[0]?.frame??s);Pi.value=null,mn({p:[n[0],n[1],n[2]],d:i?e:null,n:null,f:o}),ti.value=i?`Finding ${wt(e)}`:"Point of the surface"})}function _y(n,e){const t=Pe.peek().f;if(t===null)return;const i=lt.pointAt(t,n,e),r=(Ji.get(t)??[]).find(({box:s})=>n>=s[0]&&n<=s[2]&&e>=s[1]&&e<=s[3]);Cs(()=>{i.reason===null?Ep(i.point,r?.defect??i.finding,t):r&&$u(r.id),r&&mn({n:r.id},!0),Pi.value={frame:t,x:n,y:e,shown:i}})}function ii(n){const e=Pe.peek().f,t=e===null?-1:Qi.get(e)??-1;ni(Pt[Math.max(0,Math.min(Pt.length-1,t+n))]?.index??null,!0)}function tl(n){const e=el.peek().map(r=>r.frame).sort((r,s)=>(Qi.get(r)??0)-(Qi.get(s)??0)),t=Qi.get(Pe.peek().f??-1)??-1,i=n>0?e.find(r=>(Qi.get(r)??0)>t):e.filter(r=>(Qi.get(r)??0)<t).pop();i!==void 0&&ni(i)}function Xu(n,e=()=>!0){const t=fa.peek(),i=t.findIndex(r=>r.id===Pe.peek().d);for(let r=i+n;r>=0&&r<t.length;r+=n){const s=t[i<0&&n<0?t.length-1:r];if(s&&e(s.id))return Li(s.id)}}const wp=n=>mn({tab:n},!0),ua=n=>mn({layer:n},!0),qu=Ve(new Map),fa=Wt(()=>{const{label:n,blade:e,confidence:t,review:i,words:r}=Rr.value,s=r.trim().toLowerCase();return[...jn.value.filter(o=>(!n||o.label===n)&&(!e||String(o.blade??"")===e)&&(!t||(o.confidence?.value??0)>=Number(t))&&(!i||(qu.value.get(o.id)??"open")===i)&&(!s||`${wt(o.id).toLowerCase()} ${o.label} ${o.blade??""} ${o.side??""}`.toLowerCase().includes(s)))].sort(hy(Wu.value,la.value,Jo))});function vy(){const n=()=>{if(Mp(Pe.peek())===(location.hash||"#"))return;const r=Sp(location.hash);Pe.value=r,Vu.value=r.cam};Pe.value=Sp(location.hash),window.addEventListener("hashchange",n);const{d:e,f:t,n:i}=Pe.peek();if(t===null){const r=i===null?void 0:Ai.get(i)?.frame,s=re.frames.find(a=>a.registered&&a.picture)??Pt[0];Pe.value={...Pe.peek(),f:r??(e===null?null:ca(e))??s?.index??null}}}function Yu(n,e){if(ji.peek()){ji.value=!1;return}const t=n??Qi.get(Pe.peek().f??-1)??0,i=e??Pt.length-1;ji.value=!0;let r=t;const s=()=>{if(!ji.peek()||r>i){ji.value=!1;return}const a=Pt[r];a&&ni(a.index,!0);const o=Pt[r+1],l=a&&o&&o.video===a.video?1e3*(o.time_s-a.time_s):100;r+=1,setTimeout(s,Math.max(40,Math.min(500,l)))};s()}function xy(n,e,t){const i=Pt.flatMap((a,o)=>a.video===t&&a.time_s>=n-2&&a.time_s<=e+2?[o]:[]),[r,s]=[i[0],i[i.length-1]];r!==void 0&&s!==void 0&&Yu(r,s)}Hn(()=>{const n=He.value?`${wt(He.value.id)} ${He.value.label} · `:"";Ls(()=>document.title=`${n}${re.title}`)});const Tp=`bladeatlas review ${re.fingerprint??`${re.title} ${re.frames.length} ${re.detections.length}`} ${re.model.index}`,Ap=5,nl=Ve(Ni?[]:Ay()),Es=Wt(()=>Ni?Zm.value:nl.value),Rp=Ve(!0),Cr=Ve(null),Sy=re.defects.map(Vf),da=Wt(()=>Wf(Es.value.filter(n=>n.target.model===re.model.index),Sy)),Ku=Wt(()=>da.value.unattached),My=Wf([],[{kind:"defect",id:0,label:"",model:0,centroid:null}]).findings.get("D0").review,ha=n=>da.value.findings.get(wt(n))?.review??My,Cp=Wt(()=>{const n=jn.value.map(e=>ha(e.id).state);return{done:n.filter(e=>e!=="open").length,all:n.length}});Hn(()=>{const n=[...da.value.findings.values()];Hu.value=new Map(n.filter(e=>e.made).map(e=>{const t=-Number(e.name.slice(1));return[t,yy(t,e)]})),qu.value=new Map(n.flatMap(e=>{const t=e.made?-Number(e.name.slice(1)):Number(e.target.id);return e.review.state==="open"?[]:[[t,e.review.state]]}))}),eg();function yy(n,{target:e,made:t,review:i}){const r=t?.action==="add"?t.value:null,s=t?.action==="split"?t.value.detections:[],a=s.flatMap(u=>Ai.get(u)??[]),o=a.flatMap(u=>u.point?[u.point]:[]),l=i.point??e.centroid??(o.length?by(o):null),c=l&&St?St.nearest(l):null,f=c?lt.visibleFrames(c.point,c.normal):[],d=r?[r.frame]:a.flatMap(u=>u.frame===null?[]:[u.frame]);return{id:n,label:e.label,model:e.model,centroid:l??[NaN,NaN,NaN],confidence:null,persistence:{k:d.length,n:Math.max(d.length,f.length),share:0},events:[],detections:s,frames:f.map(u=>({frame_index:u.frame,quality:u.quality,detected:d.includes(u.frame)})),drawn:r&&{frame:r.frame,box:r.box},node:null,best_frames:d.slice(0,3),size:null,size_sigma:null,best:r?{frame:r.frame,x:(r.box[0]+r.box[2])/2,y:(r.box[1]+r.box[3])/2}:null}}const by=n=>[0,1,2].map(e=>n.reduce((t,i)=>t+i[e],0)/n.length);function Pp(n){const e=da.peek().findings.get(wt(n.id));return e?.made?e.target:Vf(n)}function er(n,e=null,t=null){const i=He.peek();if(!i)return;Zu({id:Cl(),action:n,value:e,reason:t,target:Pp(i)});const r=typeof e=="string"?e:e&&"kind"in e?`into D${e.id}`:"";ti.value=`${wt(i.id)}: ${n.replace("_"," ")}${r?` ${r}`:""}${t?`, ${t}`:""}`}function Lp(){const n=Hm(Es.peek(),Ni?Ns.peek():null);if(!n)return;const e=He.peek();Zu({id:Cl(),action:"undo",value:n.id,reason:null,target:n.target}),ti.value=`Taken back: ${n.action.replace("_"," ")}`;const t=n.target.kind==="defect"?Number(n.target.id):null;t!==null&&oa(t)?Li(t):e&&!oa(e.id)&&Li(null)}const Dp=n=>Xu(n,e=>ha(e).state==="open");function il(n){const e=Ri.peek();if(!e||n==="move"&&!He.peek())return;const[t,i,r,s]=lt.crop,a=n==="move"&&He.peek()&&lt.pixelOf(e.index,He.peek().centroid)||[(t+r)/2,(i+s)/2],o=n==="move"?6:.06*Math.min(r-t,s-i);Yt.value={what:n,box:[a[0]-o,a[1]-o,a[0]+o,a[1]+o]},ti.value=`${n==="add"?"Draw the new finding":"Put the cross where it lies"}: drag on the frame, or arrows, with Shift for the size; Enter keeps it.`}function Ip(){const n=Yt.peek(),e=Pe.peek().f;if(!n||e===null)return;if(n.what==="add")return void(Cr.value="add");const t=Np(e,n.box);t.point?(er("move",{point:t.point,...t.normal?{normal:t.normal}:{},frame:e}),Yt.value=null):ti.value=`Nothing of the surface lies there: ${t.unplaced??""}.`}function Ey(n){const e=Yt.peek(),t=Pe.peek().f;if(Yt.value=null,!e||t===null)return;const i=d=>Math.max(0,Math.min(1,d)),[r,s,a,o]=e.box,l={label:n,frame:t,box:[i(r/Be.width),i(s/Be.height),i(a/Be.width),i(o/Be.height)],...Np(t,e.box)},c=Cl();Zu({id:c,action:"add",value:l,reason:null,target:{kind:"added",id:c,label:n,model:re.model.index,centroid:l.point,sigma:null}});const f=[...da.peek().findings.values()].find(d=>d.made?.id===c);f&&Li(-Number(f.name.slice(1)),{frame:t}),ti.value=`${f?.name??""} ${n} added${l.point?"":`, without a place: ${l.unplaced??""}`}`}function Np(n,[e,t,i,r]){const s=Array.from({length:Ap},(c,f)=>(f+.5)/Ap),a=s.flatMap(c=>s.map(f=>lt.pointAt(n,e+(i-e)*f,t+(r-t)*c))),o=a.flatMap(c=>c.reason===null?[c]:[]).sort((c,f)=>c.distance-f.distance),l=o[Math.floor(o.length/2)];return l?{point:[...l.point],normal:[...l.normal]}:{point:null,unplaced:a[Math.floor(a.length/2)]?.reason??"off_surface"}}function wy(n,e,t){const[i,r]=Ci.peek(),{value:s,sigma:a,unit:o}=Kf(n,t,re.model);i&&r&&er("measure",{length:s,sigma:a,unit:o,along:e,points:[[...i],[...r]]})}function Ty(){const{title:n,fingerprint:e,model:t}=re,i=JSON.stringify({schema_version:2,title:n,fingerprint:e??null,model:t.index,records:Es.peek()},null,1),r=document.createElement("a");r.href=URL.createObjectURL(new Blob([i],{type:"application/json"})),r.download="review.json",r.click(),setTimeout(()=>URL.revokeObjectURL(r.href),1e3)}function Zu(n){const e={...n,revision:Es.peek().length+1,time:new Date().toISOString(),by:""};if(Ni){Br.peek()?Jm(e):ti.value="This key may not review.";return}if(nl.value=[...nl.peek(),e],!!Ko)try{localStorage.setItem(Tp,JSON.stringify(nl.peek()))}catch{Rp.value=!1}}function Ay(){if(!Ko)return[];try{return Vm(localStorage.getItem(Tp))??[]}catch{return[]}}let rl=null;function Up(n,e,t){const[i,r]=[n.nearest(e)?.vertex,n.nearest(t)?.vertex];if(i===void 0||r===void 0)return null;const{start:s,other:a}=Cy(n),o=n.mesh.position,l=x=>[o[3*x],o[3*x+1],o[3*x+2]],c=new Float64Array(s.length-1).fill(1/0),f=new Int32Array(s.length-1).fill(-1),d=l(r),u=new Ly;c[i]=0,u.push(di(fi(l(i),d)),i);for(let x=u.pop();x!==null&&x!==r;x=u.pop()){const m=l(x);for(let p=s[x];p<s[x+1];p++){const v=a[p],y=l(v),S=c[x]+di(fi(y,m));S<c[v]&&(c[v]=S,f[v]=x,u.push(S+di(fi(y,d)),v))}}if(c[r]===1/0)return null;const h=[[...e]],g=[];for(let x=r;x!==-1;x=f[x])g.push(x);for(const x of g.reverse())h.push([...l(x)]);return h.push([...t]),Ry(h)}function Ry(n){for(let t=0;t<4;t++)for(let i=1;i<n.length-1;i++){const[r,s,a]=[n[i-1],n[i],n[i+1]];for(let o=0;o<3;o++)s[o]=.5*s[o]+.25*(r[o]+a[o])}let e=0;for(let t=1;t<n.length;t++)e+=di(fi(n[t],n[t-1]));return e}function Cy(n){if(rl?.mesh===n.mesh)return rl;const{index:e,finding:t}=n.mesh,i=Py(n.mesh.position),r=new Uint32Array(t.length+1),s=l=>{for(let c=0;c<e.length;c+=3){const[f,d,u]=[e[c],e[c+1],e[c+2]];for(const[h,g]of[[f,d],[d,u],[u,f]])l(h,g),l(g,h)}i.forEach((c,f)=>{c!==f&&(l(c,f),l(f,c))})};s(l=>(r[l+1],r[l+1]++));for(let l=1;l<r.length;l++)r[l]+=r[l-1];const a=new Uint32Array(r[r.length-1]),o=r.slice();return s((l,c)=>a[o[l]++]=c),rl={mesh:n.mesh,start:r,other:a},rl}function Py(n){const e=new Map;return Uint32Array.from({length:n.length/3},(t,i)=>{const r=`${n[3*i]},${n[3*i+1]},${n[3*i+2]}`,s=e.get(r);return s===void 0&&e.set(r,i),s??i})}class Ly{keys=[];nodes=[];push(e,t){let i=this.keys.length;for(;i>0;){const r=i-1>>1;if(this.keys[r]<=e)break;this.keys[i]=this.keys[r],this.nodes[i]=this.nodes[r],i=r}this.keys[i]=e,this.nodes[i]=t}pop(){const e=this.nodes[0],[t,i]=[this.keys.pop(),this.nodes.pop()];if(e===void 0||t===void 0||i===void 0)return null;const r=this.keys.length;if(!r)return e;let s=0;for(;;){let a=2*s+1;if(a>=r||(a+1<r&&this.keys[a+1]<this.keys[a]&&(a+=1),this.keys[a]>=t))break;this.keys[s]=this.keys[a],this.nodes[s]=this.nodes[a],s=a}return this.keys[s]=t,this.nodes[s]=i,e}}class Dy{constructor(e,t,i){this.up=e,this.reach=t,this.moved=i}up;reach;moved;camera=new yn(35,1,.01,100);target=new N;get distance(){return this.camera.position.distanceTo(this.target)}place(e,t,i=this.up,r=35){this.camera.position.copy(e),this.target.copy(t),this.camera.up.copy(i),this.camera.lookAt(t),this.camera.fov=r,this.changed()}turn(e,t){const i=new N(1,0,0).applyQuaternion(this.camera.quaternion),r=new N(0,0,-1).applyQuaternion(this.camera.quaternion),s=Math.acos(Math.max(-1,Math.min(1,r.dot(this.up)))),a=Math.max(-(s-.05),Math.min(Math.PI-.05-s,-t)),o=new ki().setFromAxisAngle(this.up,e).multiply(new ki().setFromAxisAngle(i,-a));this.camera.position.sub(this.target).applyQuaternion(o).add(this.target),this.camera.quaternion.premultiply(o),this.changed()}pan(e,t){const i=2*this.distance*Math.tan(this.camera.fov*Math.PI/360),r=new N(-e*i,t*i,0).applyQuaternion(this.camera.quaternion);this.camera.position.add(r),this.target.add(r),this.changed()}zoom(e){const t=Math.min(20*this.reach,Math.max(.001*this.reach,this.distance*e)),i=this.camera.position.clone().sub(this.target).setLength(t);this.camera.position.copy(this.target).add(i),this.changed()}get numbers(){const e=new N(0,1,0).applyQuaternion(this.camera.quaternion);return[...this.camera.position.toArray(),...this.target.toArray(),...e.toArray(),this.camera.fov]}set numbers(e){const[t=0,i=0,r=0,s=0,a=0,o=0,l=0,c=0,f=0,d=35]=e;this.place(new N(t,i,r),new N(s,a,o),new N(l,c,f),d)}changed(){const e=this.camera.position.distanceTo(this.target)+4*this.reach;this.camera.near=Math.max(e/2e4,.001*this.reach),this.camera.far=e,this.camera.updateProjectionMatrix(),this.camera.updateMatrixWorld(),this.moved()}}function Iy(n,e,t){const i=new Map;let r=0;const s=()=>n.clientHeight||1,a=u=>{n.setPointerCapture(u.pointerId),i.size||(r=0),i.set(u.pointerId,{x:u.clientX,y:u.clientY})},o=u=>{const h=i.get(u.pointerId);if(!h)return;const[g,x]=[u.clientX-h.x,u.clientY-h.y];if(r+=Math.hypot(g,x),i.size===2){const m=[...i].find(([v])=>v!==u.pointerId)?.[1]??h,p=(v,y)=>Math.hypot(v-m.x,y-m.y)||1;e.zoom(p(h.x,h.y)/p(u.clientX,u.clientY)),e.pan(g/2/s(),x/2/s())}else u.buttons&2||u.shiftKey?e.pan(g/s(),x/s()):r>4&&e.turn(-g/s()*3.5,-x/s()*3.5);i.set(u.pointerId,{x:u.clientX,y:u.clientY})},l=u=>{if(i.delete(u.pointerId)&&!i.size&&r<=4&&u.button===0){const h=n.getBoundingClientRect();t(u.clientX-h.left,u.clientY-h.top)}},c=u=>{i.delete(u.pointerId)},f=u=>{u.preventDefault(),e.zoom(Math.exp(Math.max(-1,Math.min(1,u.deltaY/400))))},d=u=>u.preventDefault();return n.addEventListener("pointerdown",a),n.addEventListener("pointermove",o),n.addEventListener("pointerup",l),n.addEventListener("pointercancel",c),n.addEventListener("wheel",f,{passive:!1}),n.addEventListener("contextmenu",d),()=>{n.removeEventListener("pointerdown",a),n.removeEventListener("pointermove",o),n.removeEventListener("pointerup",l),n.removeEventListener("pointercancel",c),n.removeEventListener("wheel",f),n.removeEventListener("contextmenu",d)}}const Ny=`
precision highp float;
in vec3 place;
in vec3 facing;
in vec4 paint;
in float seen;
flat in float onBlade;
flat in vec2 owner;
in float beyond;
out vec4 result;
uniform vec3 eye;
uniform int layer;
uniform float chosen;
uniform float alone;
uniform vec4 plane;
uniform float exposure;
uniform vec3 palette[8];

vec3 encoded(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(max(linear, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), linear));
}
float stripes(float width) { return step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / width)); }
float dots(float width) { vec2 at = fract(gl_FragCoord.xy / width) - 0.5; return step(dot(at, at), 0.06); }

void main() {
  if (beyond > 0.0) discard;
  if (dot(plane.xyz, place) > plane.w) discard;
  if (alone > 0.0 && abs(onBlade - alone) > 0.5) discard;
  vec3 towards = normalize(eye - place);
  float lean = abs(dot(normalize(facing), towards));
  vec3 light = vec3(0.42 + 0.58 * lean);
  vec3 base = vec3(0.62);
  bool found = owner.x >= 0.0;
  vec3 own = palette[int(clamp(owner.y, 0.0, 7.0))];
  if (layer == 0) {
    base = clamp(encoded(paint.rgb * exposure), 0.0, 1.0);
    if (found) base = mix(base, own, 0.45);
  } else if (layer == 1) {
    // Blue, orange and grey stay apart for all kinds of colour blindness; patterns say the same without colour.
    base = seen >= 0.5 ? vec3(0.45, 0.68, 0.86) : seen >= 0.2 ? mix(vec3(0.93, 0.60, 0.16), vec3(0.62, 0.36, 0.05), stripes(9.0)) : mix(vec3(0.34), vec3(0.12), dots(6.0));
  } else if (layer == 2) {
    if (found) base = own;
  } else {
    if (onBlade > 0.5) base = palette[int(mod(onBlade - 1.0, 8.0))];
  }
  if (found && abs(owner.x - chosen) < 0.5) {
    // What was found must stay visible below the mark: thin lines on the picture, wide ones elsewhere.
    if (layer == 0) base = mix(clamp(encoded(paint.rgb * exposure), 0.0, 1.0), own, fract((gl_FragCoord.x + gl_FragCoord.y) / 14.0) < 0.16 ? 0.9 : 0.12);
    else base = mix(own, vec3(1.0), 0.35 * stripes(8.0));
  }
  if (!gl_FrontFacing) { base = mix(vec3(0.42, 0.43, 0.45), vec3(0.33, 0.34, 0.36), stripes(5.0)); }
  result = vec4(base * light, 1.0);
}`,Uy=`
in vec4 tint;
in float support;
in float blade;
in vec2 mark;
out vec3 place;
out vec3 facing;
out vec4 paint;
out float seen;
flat out float onBlade;
flat out vec2 owner;
out float beyond;
void pass() {
  place = position;
  facing = normal;
  paint = tint;
  seen = support;
  onBlade = blade;
  owner = mark;
}`,Fy=`
void main() {
  pass();
  beyond = 0.0;
  gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
}`,Oy=`
uniform vec4 pose[3];
uniform vec4 focus;
uniform vec4 radial;
uniform vec2 tangential;
uniform vec2 extent;
uniform vec2 depths;
uniform float fold;
uniform bool fisheye;
void main() {
  pass();
  vec4 here = vec4(position, 1.0);
  vec3 p = vec3(dot(pose[0], here), dot(pose[1], here), dot(pose[2], here));
  float across = length(p.xy);
  float angle = atan(across, p.z);
  float reach = fisheye ? angle : across / max(p.z, 1e-9);
  beyond = (p.z <= 1e-6 || reach >= fold || angle > 1.5) ? 1.0 : 0.0;
  vec2 at;
  if (fisheye) {
    float s = angle * angle;
    float radius = angle * (1.0 + s * (radial.x + s * (radial.y + s * (radial.z + s * radial.w))));
    at = across > 1e-9 ? p.xy * radius / across : vec2(0.0);
  } else {
    vec2 u = p.xy / max(p.z, 1e-9);
    float s = dot(u, u);
    at = u * (1.0 + s * (radial.x + s * radial.y)) + vec2(
      2.0 * tangential.x * u.x * u.y + tangential.y * (s + 2.0 * u.x * u.x),
      2.0 * tangential.y * u.x * u.y + tangential.x * (s + 2.0 * u.y * u.y));
  }
  vec2 pixel = at * focus.xy + focus.zw;
  float depth = (length(p) - depths.x) / (depths.y - depths.x);
  gl_Position = beyond > 0.0 ? vec4(3.0, 3.0, 3.0, 1.0)
    : vec4(2.0 * pixel.x / extent.x - 1.0, 1.0 - 2.0 * pixel.y / extent.y, 2.0 * depth - 1.0, 1.0);
}`;function Fp(n,e){return new Wi({glslVersion:Dc,side:un,vertexShader:Uy+n,fragmentShader:Ny,uniforms:{eye:{value:new N},layer:{value:0},chosen:{value:-2},alone:{value:0},plane:{value:new ot(0,0,0,1)},exposure:{value:1},palette:{value:La.map(([t,i,r])=>new N(t/255,i/255,r/255))},...e}})}const By=()=>Fp(Fy,{}),ky=()=>Fp(Oy,{pose:{value:[new ot,new ot,new ot]},focus:{value:new ot},radial:{value:new ot},tangential:{value:[0,0]},extent:{value:[1,1]},depths:{value:[0,1]},fold:{value:10},fisheye:{value:!0}}),Op=n=>zu.indexOf(n);function Bp(n){const e=[],t=4*Math.max(1,Math.floor(n.length/4/2e4));for(let r=0;r<n.length;r+=t)e.push((n[r]+n[r+1]+n[r+2])/765);e.sort((r,s)=>r-s);const i=e[Math.floor(.9*e.length)]??1;return Math.min(6,Math.max(1,.5/Math.max(i,.001)))}class zy{constructor(e,t,i,r,s){this.canvas=e,this.surface=t,this.questions=i,this.home=r,this.drawn=s,this.renderer=new Kh({canvas:e,antialias:!0,alpha:!0,preserveDrawingBuffer:!0}),this.renderer.setPixelRatio(Math.min(2,window.devicePixelRatio||1)),this.material.uniforms.exposure.value=Bp(t.mesh.color);const a=new yi(t.geometry,this.material);a.frustumCulled=!1,this.scene.add(a);const o=[...i.poses.values()];this.cameras=zp(o.flatMap(l=>this.pyramid(l,.04)),8424084),this.cameras.visible=!1,this.current=zp([],13983232),this.scene.add(this.cameras,this.current),this.orbit=new Dy(this.up(),t.radius,()=>{this.untouched=!1,this.request()}),this.whole()}canvas;surface;questions;home;drawn;orbit;renderer;scene=new Yd;material=By();cameras;current;pending=0;clipShare=0;untouched=!0;request(){this.pending||=requestAnimationFrame(()=>this.draw())}resize(e,t){!e||!t||(this.renderer.setSize(e,t,!1),this.orbit.camera.aspect=e/t,this.untouched?this.whole():this.orbit.changed())}show(e){const t=this.material.uniforms;t.layer.value=Op(e.layer),t.chosen.value=e.finding??-2,t.alone.value=e.blade??0,this.clipShare=e.clip,this.cameras.visible=e.frusta;const i=e.frame===null?void 0:this.questions.poses.get(e.frame);this.current.geometry.dispose(),this.current.geometry=kp(i?this.pyramid(i,.09):[]),this.request()}whole(){const e=new N(...this.surface.center),t=this.forward(),i=this.surface.radius/Math.tan(35*Math.PI/360)/Math.min(1,this.orbit.camera.aspect);this.orbit.place(e.clone().addScaledVector(t,-1.1*i),e),this.untouched=!0}near(e,t){const i=new N(...e.centroid),r=t===null?void 0:this.questions.poses.get(t),s=r?new N(...r.center).sub(i):new N(...e.normal??[0,0,-1]),a=Math.max(e.size??0,.06*this.surface.radius),o=Math.min(8*a,r?Math.max(s.length(),3*a):1/0),l=r?new N(...zr(r,[0,-1,0])):this.orbit.up;this.orbit.place(i.clone().add(s.setLength(o)),i,l)}from(e){const{lens:t,crop:i}=this.questions,r=this.questions.poses.get(e);if(!r||!t)return!1;const s=new N(...r.center),a=new N(...zr(r,[0,0,1])),l=this.surface.cast(r.center,a.toArray())?.distance??this.surface.radius,c=Ul(t,(i[0]+i[2])/2,i[1]),f=c?Math.atan2(Math.hypot(c[0],c[1]),c[2]):.5;return this.orbit.place(s,s.clone().addScaledVector(a,l),new N(...zr(r,[0,-1,0])),Math.min(110,360*f/Math.PI)),!0}pick(e,t){const i=this.orbit.camera,s=new N(2*e/this.canvas.clientWidth-1,1-2*t/this.canvas.clientHeight,.5).unproject(i).sub(i.position).normalize().toArray(),a=this.clipShare>0?this.clipDistance()/Math.max(1e-6,new N(...s).dot(this.ahead())):0,o=i.position.clone().addScaledVector(new N(...s),Math.max(0,a));return this.surface.cast(o.toArray(),s)}screen(e,t){const i=this.orbit.camera,r=new N(...e).project(i);if(r.z>1||Math.abs(r.x)>1.05||Math.abs(r.y)>1.05||this.clipShare>0&&new N(...e).sub(i.position).dot(this.ahead())<this.clipDistance())return null;const s=i.position.toArray(),a=t&&this.clipShare===0&&!this.surface.clear(s,e,.02*this.surface.radius);return{x:(r.x+1)/2*this.canvas.clientWidth,y:(1-r.y)/2*this.canvas.clientHeight,hidden:a}}onScreen(e){return new N(...e).applyQuaternion(this.orbit.camera.quaternion.clone().invert()).toArray()}draw(){this.pending=0;const e=this.material.uniforms,t=this.orbit.camera;e.eye.value.copy(t.position);const i=this.ahead();if(this.clipShare>0){const r=i.dot(t.position)+this.clipDistance();e.plane.value.set(-i.x,-i.y,-i.z,-r)}else e.plane.value.set(0,0,0,1);this.renderer.render(this.scene,t),this.drawn()}ahead(){return new N(0,0,-1).applyQuaternion(this.orbit.camera.quaternion)}clipDistance(){return new N(...this.surface.center).sub(this.orbit.camera.position).dot(this.ahead())+(2*this.clipShare-1)*this.surface.radius}forward(){const e=new N;for(const t of this.questions.poses.values())e.add(new N(...zr(t,[0,0,1])));return e.length()>.001*this.questions.poses.size?e.normalize():new N(0,0,1)}up(){const e=new N(...this.home.up??[0,-1,0]),t=this.forward(),i=e.clone().addScaledVector(t,-e.dot(t));return(i.length()>.2?i:e).normalize()}pyramid(e,t){const{lens:i,crop:r}=this.questions,s=t*this.surface.radius,a=[[0,1],[2,1],[2,3],[0,3]].map(([o,l])=>{const c=(i&&Ul(i,r[o],r[l]))??[o?.5:-.5,l>1?.5:-.5,.7],[f,d,u]=zr(e,c);return[e.center[0]+s*f,e.center[1]+s*d,e.center[2]+s*u]});return a.flatMap((o,l)=>[e.center,o,o,a[(l+1)%4]])}}function kp(n){const e=new Xn;return e.setAttribute("position",new Ht(new Float32Array(n.flat()),3)),e}function zp(n,e){const t=new F_(kp(n),new nh({color:new Je(e)}));return t.frustumCulled=!1,t}const Hp=new Map,Ju="http://www.w3.org/2000/svg",[ri,Gp,Hy]=[46,14,3.4];function Gy(n,e,t,i){for(const f of jn.peek()){if(!f.centroid.every(Number.isFinite))continue;const d=Hp.get(f.id)??Vy(f.id,f.label,e),u=n.screen(f.centroid,i);u?i&&(d.hidden=u.hidden):d.hidden=!0,u&&(d.style.transform=`translate(${u.x.toFixed(1)}px, ${u.y.toFixed(1)}px)`),d.classList.toggle("chosen",He.peek()?.id===f.id)}const r=[],s=Pe.peek().p,a=s&&n.screen(s,!1);a&&r.push(tr(`M${a.x-9} ${a.y}h18M${a.x} ${a.y-9}v18`,"cross under"),tr(`M${a.x-9} ${a.y}h18M${a.x} ${a.y-9}v18`,"cross"));const o=Ci.peek().map(f=>n.screen(f,!1));for(const f of o)f&&r.push(tr(`M${f.x-5} ${f.y}a5 5 0 1 0 10 0a5 5 0 1 0-10 0`,"end"));const[l,c]=o;l&&c&&r.push(tr(`M${l.x} ${l.y}L${c.x} ${c.y}`,"cross under"),tr(`M${l.x} ${l.y}L${c.x} ${c.y}`,"span")),r.push(...Wy(n,n.canvas.clientHeight)),t.replaceChildren(...r)}function Vy(n,e,t){const i=document.createElement("button");i.type="button",i.tabIndex=-1,i.className="tag";const r=document.createElementNS(Ju,"svg");r.setAttribute("viewBox","-1.3 -1.3 2.6 2.6");const s=tr(Ki.get(e)?.shape??"","");s.setAttribute("fill",Ki.get(e)?.css??"gray"),r.append(s);const a=document.createElement("span");return a.textContent=wt(n),i.append(r,a),i.title=`${wt(n)} ${e}`,i.addEventListener("click",()=>Li(n)),Hp.set(n,i),t.append(i),i}function Wy(n,e){const[t,i]=[ri+8,e-ri-8],r=[];re.up&&r.push(["up",re.up]);const s=Sg(re.row,n.surface.center);if(s&&r.push(["tip",s.tip],["root",[-s.tip[0],-s.tip[1],-s.tip[2]]]),!r.length)return[];const a=[],l=[...r.map(([c,f])=>{const[d,u]=n.onScreen(f),[h,g]=[Gp*d,-Gp*u],x=a.find(m=>Math.hypot(m.dx-h,m.dy-g)<12);return x?x.text+=`, ${c}`:a.push({text:c,dx:h,dy:g}),tr(`M${t} ${i}l${h} ${g}m${-.3*h-.2*g} ${-.3*g+.2*h}l${.3*h+.2*g} ${.3*g-.2*h}l${-.3*h+.2*g} ${-.3*g-.2*h}`,"way")}),...a.map(c=>$y(t,i,c.dx,c.dy,c.text))];return[tr(`M${t-ri} ${i}a${ri} ${ri} 0 1 0 ${2*ri} 0a${ri} ${ri} 0 1 0-${2*ri} 0`,"dial"),...l]}function $y(n,e,t,i,r){const s=Math.hypot(t,i)||1,[a,o]=[t/s,i/s],[l,c]=[Hy*r.length,6.5],f=Math.abs(a)*l+Math.abs(o)*c,d=Math.sqrt(Math.max(0,f**2+(ri-2)**2-l**2-c**2))-f,u=Math.max(0,Math.min(s+2+f,d)),h=document.createElementNS(Ju,"text");return h.setAttribute("x",String(n+u*a)),h.setAttribute("y",String(e+u*o+4)),h.setAttribute("class","way"),h.textContent=r,h}function tr(n,e){const t=document.createElementNS(Ju,"path");return t.setAttribute("d",n),e&&t.setAttribute("class",e),t}const Tn=Ve(null),Vp=Ve(null),Xy={picture:"Picture",support:"Support",defect:"Findings",blade:"Blades"};function qy(){const n=li(null),e=li(null),t=li(null);or(()=>n.current&&e.current&&t.current?Yy(n.current,e.current,t.current):void 0,[]);const i=ku??Vp.value,r=St?.mesh.blade.some(s=>s>0)??!1;return M("section",{class:"panel surface","aria-label":"Surface",children:[M("div",{class:"bar",children:[M("h2",{children:"Surface"}),M("div",{class:"choice",role:"group","aria-label":"Shading",children:zu.filter(s=>s!=="blade"||r).map(s=>M("button",{type:"button","aria-pressed":Qo.value===s,disabled:!!i,onClick:()=>ua(s),children:Xy[s]},s))}),M("div",{class:"choice",role:"group","aria-label":"View",children:[M("button",{type:"button",disabled:!!i,onClick:$p,title:"Whole surface (H)",children:"Whole"}),M("button",{type:"button",disabled:!!i||!He.value,onClick:Xp,title:"Zoom to the finding (F)",children:"Finding"}),M("button",{type:"button",disabled:!!i||!Ri.value?.registered,onClick:qp,title:"As the camera of the frame saw it (V)",children:"Camera"})]}),M("button",{type:"button","aria-pressed":bs.value,disabled:!!i,onClick:()=>bs.value=!bs.value,title:"Camera frusta (C)",children:"Frusta"}),M("button",{type:"button","aria-pressed":Ar.value,disabled:!!i,onClick:Yp,title:"Distance between two points (M)",children:"Measure"}),M("label",{class:"slide",children:["Cut ",M("input",{type:"range",min:"0",max:"1",step:"0.01",value:Gu.value,disabled:!!i,"aria-label":"Clip plane: how much of the near side is cut away",onInput:s=>Gu.value=Number(s.currentTarget.value)})]})]}),M("div",{class:Ar.value?"stage measuring":"stage",children:i?M("div",{class:"why",role:"status",children:[M("p",{children:M("b",{children:"No surface is shown."})}),M("p",{children:i}),re.flags.filter(s=>s.severity==="error").map(s=>M("p",{children:[s.text,s.advice?` ${s.advice}`:""]},s.code))]}):M(ht,{children:[M("canvas",{ref:n,tabIndex:0,role:"img","aria-label":"The reconstructed surface. Arrow keys turn it, plus and minus zoom.",onKeyDown:Ky}),M("svg",{ref:t,class:"lines","aria-hidden":"true"}),M("div",{ref:e,class:"labels","aria-hidden":"true"}),M(Zy,{}),M(Jy,{}),M(jy,{})]})})]})}function Yy(n,e,t){if(!St)return;let i,r=0;const s=g=>Gy(i,e,t,g);try{i=new zy(n,St,lt,re,()=>{s(!1),clearTimeout(r),r=window.setTimeout(()=>s(!0),120)})}catch(g){Vp.value=`This browser draws no 3D here (${g instanceof Error?g.message:String(g)}). List, frames and timeline work without.`;return}Tn.value=i;const a=()=>i.resize(n.clientWidth,n.clientHeight),o=new ResizeObserver(a);o.observe(n),a();const l=Pe.peek().cam;l&&(i.orbit.numbers=l);const c=Iy(n,i.orbit,(g,x)=>Wp(i,g,x)),f=()=>mn({cam:i.orbit.numbers.map(g=>Number(g.toPrecision(5)))},!0),d=()=>{window.setTimeout(f,300)};n.addEventListener("pointerup",d),n.addEventListener("keyup",d);let u=Pe.peek().cam?Pe.peek().d:null;const h=[Hn(()=>{i.show({layer:Qo.value,finding:He.value?.id??null,blade:Er.value,frame:Ri.value?.index??null,frusta:bs.value,clip:Gu.value}),Ci.value;const g=Pe.value.d;g!==null&&g!==u&&He.value&&i.near(He.value,Pe.peek().f),u=g}),Hn(()=>{Vu.value&&(i.orbit.numbers=Vu.value)})];return()=>{for(const g of h)g();c(),o.disconnect(),Tn.value=null}}function Wp(n,e,t){const i=n.pick(e,t);if(i){if(Ar.peek()){Ci.value=[...Ci.peek().length>=2?[]:Ci.peek(),i.point],n.request();return}Ep(i.point,i.finding)}}function $p(){Tn.peek()?.whole(),mn({cam:null},!0)}function Xp(){He.peek()&&Tn.peek()?.near(He.peek(),Pe.peek().f)}function qp(){const n=Pe.peek().f;n!==null&&Tn.peek()?.from(n)}function Yp(){Ar.value=!Ar.peek(),Ar.peek()||(Ci.value=[]),Tn.peek()?.request()}function Ky(n){const e=Tn.peek()?.orbit,t=.12,r={ArrowLeft:()=>e?.turn(t,0),ArrowRight:()=>e?.turn(-t,0),ArrowUp:()=>e?.turn(0,t),ArrowDown:()=>e?.turn(0,-t),"+":()=>e?.zoom(.85),"=":()=>e?.zoom(.85),"-":()=>e?.zoom(1.18),Enter:()=>{const s=Tn.peek();s&&Wp(s,s.canvas.clientWidth/2,s.canvas.clientHeight/2)}}[n.key];!r||n.ctrlKey||n.metaKey||n.altKey||(n.preventDefault(),n.stopPropagation(),r())}function Zy(){if(Qo.value==="support")return M("ul",{class:"legend",children:[M("li",{children:[M("i",{class:"swatch observed"})," observed"]}),M("li",{children:[M("i",{class:"swatch weak"})," weak"]}),M("li",{children:[M("i",{class:"swatch unseen"})," not seen: no finding says nothing"]})]});const n=[...new Set(re.defects.map(e=>e.label))].sort();return M("ul",{class:"legend",children:n.map(e=>M("li",{children:[M("svg",{width:"12",height:"12",viewBox:"-1.3 -1.3 2.6 2.6","aria-hidden":"true",children:M("path",{d:Ki.get(e)?.shape??"",fill:Ki.get(e)?.css??"gray",stroke:"#10151a","stroke-width":".2"})})," ",M("bdi",{children:e})]},e))})}function Jy(){if(!Ar.value)return null;const[n,e]=Ci.value,t=n?e?Qy(n,e):"Click the second point.":"Click the first point.";return M("p",{class:"measured",role:"status",children:[t,n&&e&&He.value&&M(ht,{children:[" ",M("button",{type:"button",onClick:Kp,title:"Keep (U)",children:["Keep for ",wt(He.value.id)]})]})]})}function Kp(){const[n,e]=Ci.peek();if(!n||!e||!He.peek())return;const t=St?Up(St,n,e):null,i=di(fi(n,e));wy(t===null?i:Math.max(t,i),t!==null,Math.SQRT2*lt.spacing)}function Qy(n,e){const t=Math.SQRT2*lt.spacing,i=di(fi(n,e)),r=St?Up(St,n,e):null,s=a=>{const{value:o,sigma:l,unit:c}=Kf(a,t,re.model);return`${vn(o,l,c,pn.value)}${c==="model"?" model units (unscaled)":""}`};return`Straight ${s(i)}${r===null?"; no path along the surface":`; along the surface ${s(Math.max(r,i))}`}`}function jy(){const n=re.row,e=n.status==="estimated"||n.status==="user";return M("p",{class:"orientation",children:[e?M(ht,{children:["Row: ",n.status==="user"?"told by the user":"estimated"]}):M(ht,{children:["Root, tip, blades: unknown",n.reason?` (${String(n.reason).replaceAll("_"," ")})`:""]}),He.value&&e&&M(ht,{children:[" · D",He.value.id,": blade ",Ll(He.value.blade)]})]})}class eb{constructor(e,t,i,r){this.questions=i,this.size=r,this.renderer=new Kh({canvas:e,antialias:!0,alpha:!0,preserveDrawingBuffer:!0});const s=new yi(t.geometry,this.material);s.frustumCulled=!1,this.scene.add(s),this.material.uniforms.exposure.value=Bp(t.mesh.color)}questions;size;renderer;scene=new Yd;material=ky();camera=new yn;draw(e,t,i,r){return this.renderer.setSize(Math.round(t),Math.round(i),!1),this.material.uniforms.layer.value=Op(r.layer),this.material.uniforms.chosen.value=r.finding??-2,this.material.uniforms.alone.value=r.blade??0,this.aim(e)?(this.renderer.render(this.scene,this.camera),!0):(this.renderer.clear(),!1)}silhouette(e,t,i){const r=new Dn(t,i),s=new Uint8Array(t*i);if(this.aim(e)){this.renderer.setRenderTarget(r),this.renderer.clear(),this.renderer.render(this.scene,this.camera);const a=new Uint8Array(4*t*i);this.renderer.readRenderTargetPixels(r,0,0,t,i,a),this.renderer.setRenderTarget(null);for(let o=0;o<i;o++)for(let l=0;l<t;l++)s[o*t+l]=a[4*((i-1-o)*t+l)+3]>127?1:0}return r.dispose(),s}aim(e){const{lens:t,limit:i,surface:r}=this.questions,s=this.questions.poses.get(e);if(!s||!t||!r)return!1;const a=this.material.uniforms;for(let l=0;l<3;l++)a.pose.value[l].fromArray(s.m,4*l);a.focus.value.set(t.fx,t.fy,t.cx,t.cy),a.radial.value.set(...t.radial),a.tangential.value=[...t.tangential],a.extent.value=[this.size.width,this.size.height];const o=di(fi(s.center,r.center))+3*r.radius;return a.depths.value=[0,o],a.fold.value=Math.min(i,100),a.fisheye.value=t.fisheye,a.eye.value.set(...s.center),!0}}function sl({label:n,px:e=14}){const t=Ki.get(n);return M("svg",{class:"mark",width:e,height:e,viewBox:"-1.3 -1.3 2.6 2.6","aria-hidden":"true",children:M("path",{d:t?.shape??"",fill:t?.css??"gray",stroke:"#10151a","stroke-width":".22"})})}function al({frame:n,width:e=64}){const t=re.sprite;if(!t||!n||n.tile===null)return M("span",{class:"tile none",style:{width:`${e}px`,height:`${e*Be.height/Be.width}px`}});const i=e/t.width,[r,s]=[n.tile%t.columns,Math.floor(n.tile/t.columns)];return M("span",{class:"tile",style:{width:`${e}px`,height:`${t.height*i}px`},children:M("img",{src:t.file,alt:"",style:{width:`${t.width*t.columns*i}px`,left:`${-r*e}px`,top:`${-s*t.height*i}px`}})})}function tb({finding:n,width:e=60}){const t=Zi.get(ca(n.id)??-1),i=n.detections.map(o=>Ai.get(o)).find(o=>o!==void 0&&o.frame===t?.index),r=n.best&&n.best.frame===t?.index&&n.best.x!==null&&n.best.y!==null?n.best:null,s=r&&{x:r.x*Be.width,y:r.y*Be.height},a=i?.box??(s?[s.x-40,s.y-40,s.x+40,s.y+40]:null);return M(Zp,{frame:t,box:a,width:e})}function nb({detection:n,width:e=48}){return M(Zp,{frame:Zi.get(n.frame??-1),box:n.box,width:e})}function Zp({frame:n,box:e,width:t}){const i=t*.75;if(!n?.picture||!e)return M(al,{frame:n,width:t});const[r,s,a,o]=e,l=Math.min(Be.width,Math.max(60,2*(a-r),2.6*(o-s))),c=t/l,f=(d,u,h)=>Math.max(0,Math.min(h-2*u,d-u));return M("span",{class:"tile",style:{width:`${t}px`,height:`${i}px`},children:M("img",{src:n.picture,alt:"",loading:"lazy",decoding:"async",style:{width:`${Be.width*c}px`,height:`${Be.height*c}px`,left:`${-c*f((r+a)/2,l/2,Be.width)}px`,top:`${-c*f((s+o)/2,l*.75/2,Be.height)}px`}})})}const si=Ve(1),ws=Ve(1);let Qu=null;function Jp(n){if(!Qu&&St)try{Qu=new eb(n,St,lt,Be)}catch{return null}return Qu}const ib={outlines:"filled",filled:"off",off:"outlines"},Qp=()=>{wr.value=ib[wr.peek()]};function rb(){const n=li(null),e=li(null),t=Ri.value;or(()=>{const r=n.current;if(!r)return;const s=()=>{const l=Math.min(Be.width,1.03*(lt.crop[2]-lt.crop[0])),c=Math.min(Be.height,1.03*(lt.crop[3]-lt.crop[1]));ws.value=Math.max(80,Be.width*Math.min(r.clientWidth/l,r.clientHeight/c)),jp(r)},a=new ResizeObserver(s);a.observe(r),s();const o=Hn(()=>{const l=Pe.value.f,c={layer:Qo.value,finding:He.value?.id??null,blade:Er.value},f=Math.min(2048,ws.value*si.value*Math.min(2,window.devicePixelRatio||1));Tr.value>0&&e.current&&l!==null&&Jp(e.current)?.draw(l,f,f*Be.height/Be.width,c)});return()=>{a.disconnect(),o()}},[]),or(()=>jp(n.current),[Pe.value.f,Pe.value.d,si.value,ws.value]);const i=ws.value*si.value;return M("section",{class:"panel frame","aria-label":"Frame",children:[M("div",{class:"bar",children:[M("h2",{children:["Frame ",t?t.source_index:""]}),t&&M("span",{class:"time",children:[re.videos.length>1?`video ${t.video}, `:"",_n(t.time_s)]}),M("div",{class:"choice",role:"group","aria-label":"Frames of the video",children:[M("button",{type:"button",onClick:()=>ii(-1),"aria-label":"Previous frame of the video",title:"Previous frame (,)",children:"‹"}),M("button",{type:"button",onClick:()=>ii(1),"aria-label":"Next frame of the video",title:"Next frame (.)",children:"›"})]}),M("div",{class:"choice",role:"group","aria-label":"Frames that show the selection",children:[M("button",{type:"button",disabled:!el.value.length,onClick:()=>tl(-1),"aria-label":"Previous frame that shows the selection",title:"Previous frame of the selection ([)",children:"«"}),M("button",{type:"button",disabled:!el.value.length,onClick:()=>tl(1),"aria-label":"Next frame that shows the selection",title:"Next frame of the selection (])",children:"»"})]}),M("button",{type:"button",onClick:Qp,title:"Boxes and masks (X)","aria-label":`Boxes and masks: ${wr.value}; change`,children:["Boxes: ",wr.value]}),M("label",{class:"slide",children:["Overlay ",M("input",{type:"range",min:"0",max:"1",step:"0.05",value:Tr.value,disabled:!t?.registered||!St,"aria-label":"How opaque the surface lies over the frame",onInput:r=>Tr.value=Number(r.currentTarget.value)})]}),M("div",{class:"choice",role:"group","aria-label":"Size of the picture",children:[M("button",{type:"button",onClick:()=>si.value=Math.max(.5,si.value/1.5),"aria-label":"Smaller picture",children:"−"}),M("button",{type:"button",onClick:()=>si.value=Math.min(8,si.value*1.5),"aria-label":"Larger picture",children:"+"})]})]}),M("div",{class:si.value>1?"pane large":"pane",ref:n,tabIndex:0,role:"group","aria-label":"Picture of the frame",children:M("div",{class:"picture",style:{width:`${i}px`,height:`${i*Be.height/Be.width}px`},onClick:ub,onPointerDown:ob,onPointerMove:em,onPointerUp:lb,children:[t?.picture?M("img",{src:t.picture,alt:sb(),draggable:!1}):M("div",{class:"why",children:[t&&re.sprite?M(al,{frame:t,width:Math.min(ws.value*.5,320)}):null,M("p",{children:re.pictures_reason??"No picture of this frame was kept."})]}),M("canvas",{ref:e,class:"over",style:{opacity:String(t?.registered?Tr.value:0)},"aria-hidden":"true"}),M(fb,{width:i})]})}),M(hb,{}),M(pb,{})]})}function sb(){const n=Ri.value;if(!n)return"";const e=(Ji.get(n.index)??[]).map(t=>t.label);return`Frame ${n.source_index} at ${_n(n.time_s)}: ${e.length?e.join(", "):"no detection"}`}function jp(n){const[e,t,i,r]=lt.crop,s=si.peek()>1&&ab()||[(e+i)/2,(t+r)/2];if(!n)return;const a=ws.peek()*si.peek()/Be.width;n.scrollTo(s[0]*a-n.clientWidth/2,s[1]*a-n.clientHeight/2)}function ab(){const{f:n,p:e}=Pe.peek();if(n===null)return null;const t=(Ji.get(n)??[]).find(r=>ys.peek()?r.id===ys.peek()?.id:r.defect===He.peek()?.id);if(t)return[(t.box[0]+t.box[2])/2,(t.box[1]+t.box[3])/2];const i=e??He.peek()?.centroid;return i?lt.pixelOf(n,i):null}function ju(n){const e=n.currentTarget.getBoundingClientRect();return[(n.clientX-e.left)/e.width*Be.width,(n.clientY-e.top)/e.height*Be.height]}let nr=null,ef=!1;function ob(n){!Yt.peek()||n.button||(n.preventDefault(),n.currentTarget.setPointerCapture(n.pointerId),nr=ju(n))}function em(n){const e=Yt.peek();if(!e||!nr)return;const[t,i]=ju(n),r=e.what==="move"?[t-6,i-6,t+6,i+6]:[Math.min(t,nr[0]),Math.min(i,nr[1]),Math.max(t,nr[0]),Math.max(i,nr[1])];r[2]-r[0]>2&&r[3]-r[1]>2&&(Yt.value={...e,box:r})}function lb(n){!Yt.peek()||!nr||(em(n),nr=null,ef=!0,Ip())}function cb({unit:n}){const e=Yt.value;if(!e)return null;const[t,i,r,s]=e.box;return M(ht,{children:[M("rect",{class:"halo",x:t,y:i,width:r-t,height:s-i,fill:"none",stroke:"#000","stroke-width":4*n}),M("rect",{class:"pending",x:t,y:i,width:r-t,height:s-i,"stroke-width":2*n})]})}function ub(n){!Yt.peek()&&!ef&&_y(...ju(n)),ef=!1}function fb({width:n}){const e=Ri.value;if(!e)return null;const t=Be.width/Math.max(1,n),i=He.value?.id,{p:r}=Pe.value,s=r??(He.value?He.value.centroid:null),a=s&&e.registered?lt.pixelOf(e.index,s):null,o=Pi.value?.frame===e.index?Pi.value:null;return M("svg",{class:"drawn",viewBox:`0 0 ${Be.width} ${Be.height}`,"aria-hidden":"true",children:[wr.value!=="off"&&(Ji.get(e.index)??[]).map(l=>{const c=Ki.get(l.label),[f,d,u,h]=l.box,g=f>.7*Be.width,x=l.defect!==null&&l.defect===i||l.id===ys.value?.id,m={stroke:c?.css??"gray",fill:wr.value==="filled"?c?.css??"gray":"none"},p=l.state==="mapped"?"none":`${5*t} ${4*t}`,v=(y,S)=>l.polygon?M("polygon",{class:S,points:l.polygon.map(E=>E.join(",")).join(" "),...y}):M("rect",{class:S,x:f,y:d,width:u-f,height:h-d,...y});return M("g",{children:[v({fill:"none",stroke:"#000","stroke-opacity":.6,"stroke-width":(x?5:3.4)*t},"halo"),v({...m,"fill-opacity":.3,"stroke-width":(x?3:1.6)*t,"stroke-dasharray":p},x?"box strong":"box"),M("text",{x:g?u:f,"text-anchor":g?"end":"start",y:Math.max(14*t,d-5*t),"font-size":12.5*t,"stroke-width":3*t,class:"name",children:[l.defect!==null?`${wt(l.defect)} `:"",l.label]})]},l.id)}),wr.value!=="off"&&jn.value.map(l=>l.drawn?.frame===e.index&&M("g",{children:[M("rect",{class:"halo",x:l.drawn.box[0]*Be.width,y:l.drawn.box[1]*Be.height,width:(l.drawn.box[2]-l.drawn.box[0])*Be.width,height:(l.drawn.box[3]-l.drawn.box[1])*Be.height,fill:"none",stroke:"#000","stroke-opacity":.6,"stroke-width":4*t}),M("rect",{class:"by-hand",x:l.drawn.box[0]*Be.width,y:l.drawn.box[1]*Be.height,width:(l.drawn.box[2]-l.drawn.box[0])*Be.width,height:(l.drawn.box[3]-l.drawn.box[1])*Be.height,"stroke-width":2*t}),M("text",{x:l.drawn.box[0]*Be.width,y:l.drawn.box[3]*Be.height+14*t,"font-size":12.5*t,"stroke-width":3*t,class:"name",children:[wt(l.id)," ",l.label]})]},l.id)),M(cb,{unit:t}),a&&M("path",{class:"spot",d:db(a[0],a[1],9*t),"stroke-width":1.6*t}),o&&o.shown.reason!==null&&M("path",{class:"spot miss",d:`M${o.x-7*t} ${o.y-7*t}l${14*t} ${14*t}m0 ${-14*t}l${-14*t} ${14*t}`,"stroke-width":2*t}),M("rect",{class:"used",x:lt.crop[0],y:lt.crop[1],width:lt.crop[2]-lt.crop[0],height:lt.crop[3]-lt.crop[1],"stroke-width":t,"stroke-dasharray":`${2*t} ${5*t}`})]})}function db(n,e,t){return`M${n-t} ${e}H${n-t/3}M${n+t/3} ${e}H${n+t}M${n} ${e-t}V${e-t/3}M${n} ${e+t/3}V${e+t}`}function hb(){const n=Ri.value,e=Pi.value;let t="";if(n&&!n.registered)t=`Not registered: ${ur(re,n.reason??"not_registered")}. The surface cannot be laid over it.`;else if(ku)t=ku;else if(e?.shown.reason===null){const{distance:i,incidence_deg:r,finding:s,support:a}=e.shown,o=re.model.unit==="model"?"":` ${re.model.unit}`;t=`${s>=0?`Finding ${wt(s)}`:"The surface"}: ${vn(i,null,re.model.unit)}${o?"":" model units"} from the camera, seen at ${Math.round(r)}° from straight on, ${a>=.5?"well observed":"weakly observed"}.`}else e?t=`Nothing there: ${ur(re,e.shown.reason)}.`:t="Click the picture: its place on the surface is shown. Click the surface: the frames that see it are ranked here.";return M("p",{class:"said",role:"status",children:t})}function pb(){const n=el.value;if(!n.length)return null;const e=Pe.value.p?"this point":wt(He.value?.id??0),t=new Set(He.value?.detections.map(i=>Ai.get(i)?.frame)??[]);return M("div",{class:"ranked",role:"group","aria-label":`Frames that see ${e}, best first`,children:[M("span",{class:"lead",children:[n.length," ",n.length===1?"frame sees":"frames see"," ",e]}),M("ol",{children:n.slice(0,60).map(i=>{const r=Zi.get(i.frame);return r?M("li",{children:M("button",{type:"button","aria-current":Pe.value.f===i.frame,onClick:()=>ni(i.frame),"aria-label":`Frame ${r.source_index}, view quality ${cr(i.quality)}${t.has(i.frame)?", detected there":""}`,children:[M(al,{frame:r,width:44}),M("small",{children:[r.source_index,t.has(i.frame)?" ■":""]})]})},i.frame):null})})]})}const Pr=n=>{He.peek()&&(Cr.value=n)},tf=[{group:"Findings",keys:["ArrowDown","j"],says:"next finding of the list",run:()=>Xu(1)},{group:"Findings",keys:["ArrowUp","k"],says:"previous finding",run:()=>Xu(-1)},{group:"Findings",keys:["Escape"],says:"select nothing",run:()=>{Li(null)}},{group:"Review",keys:["ArrowRight"],says:"next finding without a review",run:()=>Dp(1)},{group:"Review",keys:["ArrowLeft"],says:"previous finding without a review",run:()=>Dp(-1)},{group:"Review",keys:["a"],says:"accept",run:()=>er("accept")},{group:"Review",keys:["r"],says:"reject, with a reason",run:()=>Pr("reject")},{group:"Review",keys:["l"],says:"give another label",run:()=>Pr("relabel")},{group:"Review",keys:["n"],says:"write a note",run:()=>Pr("note")},{group:"Review",keys:["s"],says:"severity: what shall be done",run:()=>Pr("severity")},{group:"Review",keys:["t"],says:"tell its blade",run:()=>Pr("set_blade")},{group:"Review",keys:["g"],says:"merge it into another finding",run:()=>Pr("merge")},{group:"Review",keys:["y"],says:"split detections off",run:()=>{(He.peek()?.detections.length??0)>1&&Pr("split")}},{group:"Review",keys:["w"],says:"move it: arrows or a click in the frame, Enter keeps",run:()=>il("move")},{group:"Review",keys:["d"],says:"add a finding: draw it on the frame, Enter keeps",run:()=>il("add")},{group:"Review",keys:["u"],says:"keep the measured length",run:Kp},{group:"Review",keys:["z"],says:"take the last action back",run:Lp},{group:"Frame",keys:["."],says:"next frame of the video",run:()=>ii(1)},{group:"Frame",keys:[","],says:"previous frame of the video",run:()=>ii(-1)},{group:"Frame",keys:["]"],says:"next frame that shows the selection",run:()=>tl(1)},{group:"Frame",keys:["["],says:"previous frame that shows the selection",run:()=>tl(-1)},{group:"Frame",keys:["b"],says:"best frame of the finding",run:()=>{He.peek()&&ni(ca(He.peek().id))}},{group:"Frame",keys:["o"],says:"surface over the frame: off, half, full",run:()=>{Tr.value=Tr.peek()===0?.5:Tr.peek()<1?1:0}},{group:"Frame",keys:["x"],says:"boxes and masks: outlines, filled, off",run:Qp},{group:"Frame",keys:["p"],says:"play or stop",run:()=>Yu()},{group:"Surface",keys:["v"],says:"view from the camera of the frame",run:qp},{group:"Surface",keys:["f"],says:"zoom to the finding",run:Xp},{group:"Surface",keys:["h"],says:"whole surface",run:$p},{group:"Surface",keys:["1"],says:"shading by picture",run:()=>ua("picture")},{group:"Surface",keys:["2"],says:"shading by support: what was observed",run:()=>ua("support")},{group:"Surface",keys:["3"],says:"shading by finding",run:()=>ua("defect")},{group:"Surface",keys:["4"],says:"shading by blade",run:()=>{St?.mesh.blade.some(n=>n>0)&&ua("blade")}},{group:"Surface",keys:["c"],says:"camera frusta",run:()=>{bs.value=!bs.peek()}},{group:"Surface",keys:["m"],says:"measure: Enter or a click sets a point",run:Yp},{group:"Surface",keys:["+"],says:"nearer",run:()=>Tn.peek()?.orbit.zoom(.85)},{group:"Surface",keys:["-"],says:"farther",run:()=>Tn.peek()?.orbit.zoom(1.18)},{group:"Page",keys:["?"],says:"this list",run:()=>{ei.value=!ei.peek()}}];function mb(n){const e=Yt.peek(),t={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,-1],ArrowDown:[0,1]}[n.key];if(n.key==="Enter")Ip();else if(n.key==="Escape")Yt.value=null;else{if(!e||!t)return!1;{const[i,r]=t.map(d=>d*Be.width/100),[s,a,o,l]=e.box,c=n.shiftKey,f=[s+(c?0:i),a+(c?0:r),o+i,l+r];f[2]-f[0]>2&&f[3]-f[1]>2&&(Yt.value={...e,box:f})}}return n.preventDefault(),!0}const tm="bladeatlas keys off",nf=Ve(_b());function gb(n){if(nf.value=n,!!Ko)try{localStorage.setItem(tm,n?"":"1")}catch{}}function _b(){if(!Ko)return!0;try{return localStorage.getItem(tm)!=="1"}catch{return!0}}function vb(){document.addEventListener("keydown",n=>{if(n.ctrlKey||n.metaKey||n.altKey||n.defaultPrevented)return;const e=n.target,t=e.matches("input:not([type=range],[type=checkbox]), select, textarea"),i=e.matches("input[type=range]")&&n.key.startsWith("Arrow");if(t||i||ei.peek()&&n.key!=="?"&&n.key!=="Escape"||Yt.peek()&&mb(n))return;if(n.key==="Escape")return ei.peek()?void(ei.value=!1):(ji.value=!1,Cr.value=null,Pe.peek().d!==null||Pe.peek().p?Li(null):mn({n:null},!0));if(!nf.peek()&&n.key!=="?")return;const r=tf.find(({keys:s})=>s.includes(n.key)||s.includes(n.key.toLowerCase()));r&&(n.preventDefault(),r.run())})}function xb({one:n}){const{state:e,reason:t,severity:i}=ha(n.id),r=!Br.value,s=a=>()=>Cr.value=a;return M("div",{class:"review-bar",role:"group","aria-label":"Review",children:[M("button",{type:"button",disabled:r,"aria-pressed":e==="accepted",onClick:()=>er("accept"),title:"Accept (A)",children:"Accept"}),M("button",{type:"button",disabled:r,"aria-pressed":e==="rejected",onClick:s("reject"),title:"Reject (R)",children:["Reject",e==="rejected"&&t?`: ${t}`:""]}),M("button",{type:"button",disabled:r,onClick:s("severity"),title:"Severity (S)",children:["Severity",i?`: ${i}`:""]}),M("button",{type:"button",disabled:r,onClick:s("relabel"),title:"Label (L)",children:"Label"}),M("button",{type:"button",disabled:r,onClick:s("note"),title:"Note (N)",children:"Note"}),M("button",{type:"button",disabled:r,onClick:s("set_blade"),title:"Blade (T)",children:"Blade"}),M("button",{type:"button",disabled:r,onClick:()=>il("move"),title:"Move (W)",children:"Move"}),M("button",{type:"button",disabled:r||jn.value.length<2,onClick:s("merge"),title:"Merge (G)",children:"Merge"}),M("button",{type:"button",disabled:r||n.detections.length<2,onClick:s("split"),title:"Split (Y)",children:"Split"}),M("button",{type:"button",disabled:r||!Es.value.length,onClick:Lp,title:"Take back (Z)",children:"Undo"})]})}const nm={reject:"Why is it rejected?",relabel:"The right label",note:"Note",severity:"What shall be done?",set_blade:"Blade (empty: on none)",merge:"It is the same as",split:"Detections that are a finding of their own",add:"What is it?"};function Sb(){const n=Cr.value,e=li(null),t=He.value;if(wm(()=>e.current?.querySelector("select, input")?.focus(),[n]),!n||!t&&n!=="add")return null;const i=()=>{Cr.value=null,Yt.value=null},r=s=>{s.preventDefault();const a=new FormData(e.current),o=String(a.get("value")??"").trim();if(Cr.value=null,n==="reject")er("reject",null,o);else if(n==="split"){const l=a.getAll("detection").map(Number);l.length&&l.length<(t?.detections.length??0)&&er("split",{detections:l})}else if(n==="merge"){const l=jn.peek().find(c=>c.id===Number(o));l&&er("merge",Pp(l))}else n==="add"?o&&Ey(o):(o||n==="set_blade")&&er(n,o)};return M("form",{class:"ask",ref:e,onSubmit:r,onKeyDown:s=>{s.key==="Escape"?(s.stopPropagation(),i()):s.key==="Enter"&&!s.target.matches("button")&&r(s)},children:[n==="split"?M(yb,{one:t}):M("label",{children:[nm[n],M(Mb,{what:n,one:t})]}),M("datalist",{id:"known-labels",children:[...new Set(re.detections.map(s=>s.label))].map(s=>M("option",{value:s},s))}),M("button",{type:"submit",children:"Keep"}),M("button",{type:"button",onClick:i,children:"Leave"})]})}function Mb({what:n,one:e}){if(n==="reject"||n==="severity")return M("select",{name:"value",children:(n==="reject"?Fm:Qf.value).map(r=>M("option",{children:r},r))});if(n==="merge")return M("select",{name:"value",children:jn.value.filter(r=>r.id!==e?.id).map(r=>M("option",{value:r.id,children:[wt(r.id)," ",r.label]},r.id))});const t=n==="relabel"||n==="add",i=n==="relabel"?e?.label:n==="set_blade"?e&&(ha(e.id).blade??String(e.blade??"")):"";return M("input",{name:"value",type:"text",maxLength:n==="note"?2e3:n==="set_blade"?64:100,defaultValue:i??"",...t?{list:"known-labels"}:{}})}function yb({one:n}){return M("fieldset",{children:[M("legend",{children:nm.split}),n.detections.map(e=>{const t=Ai.get(e);return M("label",{class:"check",children:[M("input",{type:"checkbox",name:"detection",value:e})," ",e," ",M("bdi",{children:t?.label}),t?.frame===null||t===void 0?"":`, frame ${Zi.get(t.frame)?.source_index??t.frame}`]},e)})]})}function bb({review:n}){const e=[];n.merged_into&&e.push(["Merged into",n.merged_into]),n.severity&&e.push(["Severity",n.severity]),n.blade!==null&&e.push(["Blade",n.blade||"on none"]),n.point&&e.push(["Moved to",n.point.map(t=>t.toFixed(3)).join(", ")]);for(const t of n.measures.slice(-1))e.push(["Measured",vn(t.length,t.sigma,t.unit,pn.value)]);return n.without.length&&e.push(["Without detections",n.without.join(", ")]),!e.length&&!n.notes.length&&!n.by?null:M("div",{class:"said-by",role:"group","aria-label":"What people say",children:[M("h3",{children:["People say",n.by?M(ht,{children:[" (",M("bdi",{children:n.by}),")"]}):""]}),M("dl",{children:e.map(([t,i])=>M("div",{children:[M("dt",{children:t}),M("dd",{children:M("bdi",{children:i})})]},t))}),n.notes.length>0&&M("ul",{class:"reasons",children:n.notes.map((t,i)=>M("li",{children:[M("bdi",{children:t.text}),t.by&&M("small",{children:[" ",M("bdi",{children:t.by})]})]},i))})]})}function Eb(){const n=ui.value.length;return M("div",{class:"exports",children:[M(wb,{}),Us.value&&M("p",{role:"status",children:[Us.value," ",M("button",{type:"button",class:"link",onClick:()=>Us.value="",children:"Seen"})]}),M("span",{children:["Reviewed ",Cp.value.done," of ",Cp.value.all,".",Ni&&Br.value?n?` ${n} not sent yet.`:" Kept by the service.":""]}),Ni&&!Br.value&&M("span",{class:"warn",children:"Your key may not review."}),M("button",{type:"button",disabled:!Br.value,onClick:()=>il("add"),title:"Add a finding (D)",children:"Add a finding"}),M("button",{type:"button",disabled:!Es.value.length,onClick:Ty,children:"Save review.json"}),Ni&&M("a",{href:Km,children:"Report"}),!Rp.value&&M("span",{class:"warn",children:"This browser keeps nothing for this page: save before you close it."}),Ku.value.length>0&&M("details",{children:[M("summary",{children:[Ku.value.length," reviewed before and not found here"]}),M("ul",{class:"reasons",children:Ku.value.map(e=>M("li",{children:[M("bdi",{children:e.target.label})," (was ",String(e.target.id).slice(0,6),"): ",e.review.state,e.review.notes.map((t,i)=>M("bdi",{children:[", ",t.text]},i))]},e.name))})]})]})}function wb(){const n=jt.value;if(!n)return null;const e=ui.value[0];return M("div",{class:"trouble",role:"alert",children:[M("p",{children:n.text}),n.others.length>0&&M("ul",{children:n.others.map(t=>M("li",{children:[M("bdi",{children:t.by}),": ",t.action,typeof t.value=="string"?M(ht,{children:[" ",M("bdi",{children:t.value})]}):"",t.reason?`, ${t.reason}`:""]},t.id))}),(n.kind==="conflict"||n.kind==="refused")&&e&&M("p",{children:["Yours: ",e.action,e.reason?`, ${e.reason}`:"",". ",M("button",{type:"button",onClick:Qm,children:"Send mine too"})," ",M("button",{type:"button",onClick:jm,children:"Leave mine out"})]}),n.kind==="sign-in"&&M("a",{href:Ym,children:"To the start page"})]})}function Tb(){const[n,e]=[He.value,ys.value];return M("section",{class:"panel detail","aria-label":"Selection",children:[n?M(Rb,{one:n}):e?M(Cb,{own:e}):M(Ab,{}),M(Sb,{}),M(Eb,{})]})}function Ab(){return M(ht,{children:[M("p",{class:"note",children:"Nothing is selected. Choose a finding, click the surface, or click a box of the frame."}),Zo.length>0&&M("div",{class:"coverage",children:[M("h3",{children:"Not seen by two views"}),M("ul",{class:"reasons",children:Zo.map(({name:n,seen:e})=>M("li",{children:[cr(1-e)," of blade ",n]},n))}),M("p",{class:"note",children:"Of the reconstructed surface, at a usable angle. What no view saw has no surface and is not counted."})]})]})}function Rb({one:n}){const e=ha(n.id),t=n.length_unit??n.size_unit??re.model.unit,i=Jo.get(n.id)??[],r=Zo.find(({name:s})=>s===String(n.blade))?.number;return M(ht,{children:[M("h2",{children:[M(sl,{label:n.label})," ",wt(n.id)," ",M("bdi",{children:n.label}),e.label&&M("span",{class:"human",children:[" → ",M("bdi",{children:e.label})]})]}),M(xb,{one:n}),M(bb,{review:e}),M("dl",{children:[M(Kt,{name:"Size",children:[vn(n.size,n.size_sigma,t,pn.value)," ",M(Pb,{unit:t})]}),n.length!==void 0&&M(Kt,{name:"Length × width",children:[vn(n.length,n.length_sigma,t,pn.value)," × ",vn(n.width,n.width_sigma,t,pn.value)]}),n.area!==void 0&&n.area!==null&&M(Kt,{name:"Area",children:vn(n.area,n.area_sigma,t==="model"?"model":`${t}²`,pn.value)}),n.depth!==void 0&&n.depth!==null&&M(Kt,{name:"Depth",children:vn(n.depth,n.depth_sigma,t,pn.value)}),M(Kt,{name:"Blade",children:[Ll(n.blade),n.side?`, ${n.side.replaceAll("_"," ")}`:"",r!==void 0&&St?.mesh.blade.some(s=>s===r)&&M("button",{type:"button",class:"link",onClick:()=>mn({b:Er.value===null?r:null},!0),children:Er.value===null?"show it alone":"show all"})]}),n.span!==void 0&&M(Kt,{name:"Span, chord",children:[im(n.span,n.span_sigma),", ",im(n.chord,n.chord_sigma)]}),n.root_distance!==void 0&&n.root_distance!==null&&M(Kt,{name:"From the root",children:vn(n.root_distance,n.root_distance_sigma,t,pn.value)}),n.edge_distance!==void 0&&n.edge_distance!==null&&M(Kt,{name:"From an edge",children:vn(n.edge_distance,n.edge_distance_sigma,t,pn.value)}),n.limits&&M(Kt,{name:"Limits of the shop",children:[M("b",{children:n.limits.verdict.replaceAll("_"," ")}),": ",n.limits.reason,". What it means for the part a person says."]}),M(Kt,{name:"Persistence",children:["detected in ",n.persistence.k," of the ",n.persistence.n," frames that could show it"]}),M(Kt,{name:"Place",children:[n.centroid.every(Number.isFinite)?n.centroid.map(s=>s.toFixed(3)).join(", "):"none on the surface",n.centroid_sigma?` ± ${n.centroid_sigma.toPrecision(2)}`:""]})]}),M("h3",{children:"Visits"}),M("ul",{class:"chips",children:i.map(s=>M("li",{children:M("button",{type:"button",onClick:()=>xy(s.start_s,s.end_s,s.video??0),"aria-label":`Play the visit from ${_n(s.start_s)} to ${_n(s.end_s)}`,children:["▶ ",re.videos.length>1?`video ${s.video??0}, `:"",_n(s.start_s)," to ",_n(s.end_s)," · ",s.n_detections]})},s.event_id))}),M("h3",{children:"Best frames"}),M("ul",{class:"chips",children:n.best_frames.map((s,a)=>M("li",{children:M("button",{type:"button","aria-current":Pe.value.f===s,onClick:()=>ni(s),children:[a===0?"best: ":"","frame ",Zi.get(s)?.source_index??s]})},s))}),M("h3",{children:["Confidence ",n.confidence?`${cr(n.confidence.value)}, ${Pl(n.confidence.value)}`:"unknown"]}),M("ul",{class:"reasons",children:Xm(n).map(s=>M("li",{children:s},s))})]})}function Cb({own:n}){return M(ht,{children:[M("h2",{children:[M(sl,{label:n.label})," Detection ",n.id," ",M("bdi",{children:n.label})]}),M("dl",{children:[M(Kt,{name:"State",children:n.state}),n.reason&&M(Kt,{name:"Why",children:ur(re,n.reason)}),n.score!==null&&n.score!==void 0&&M(Kt,{name:"Detector's score",children:n.score.toFixed(2)}),n.confidence!==null&&M(Kt,{name:"Confidence",children:cr(n.confidence)}),n.frame===null&&M(Kt,{name:"Frame",children:"no frame of the run shows it"})]})]})}function Kt({name:n,children:e}){return M("div",{children:[M("dt",{children:n}),M("dd",{children:e})]})}function Pb({unit:n}){return n==="model"?M("small",{children:"model units, unscaled"}):null}function im(n,e){return n==null?"unknown":`${cr(n)}${e?` ± ${Math.max(1,Math.round(100*e))}`:""}`}const Lb={ArrowDown:"↓",ArrowUp:"↑",ArrowLeft:"←",ArrowRight:"→",Escape:"Esc"};function Db(){const n=li(null);return or(()=>{ei.value?n.current?.showModal():n.current?.close()},[ei.value]),M("dialog",{ref:n,"aria-labelledby":"help",onClose:()=>ei.value=!1,children:[M("h2",{id:"help",children:"Keys"}),M("div",{class:"keys",children:[...new Set(tf.map(e=>e.group))].map(e=>M("section",{"aria-label":e,children:[M("h3",{children:e}),M("dl",{children:tf.filter(t=>t.group===e).map(t=>M("div",{children:[M("dt",{children:t.keys.map(i=>M("kbd",{children:Lb[i]??i.toUpperCase()},i))}),M("dd",{children:t.says})]},t.says))})]},e))}),M("p",{children:"On the surface arrows turn the view; on the timeline they step frames. Drag turns, right drag or shift drag shifts, the wheel zooms."}),M("p",{children:M("label",{class:"check",children:[M("input",{type:"checkbox",checked:nf.value,onChange:e=>gb(e.currentTarget.checked)})," single keys act"]})}),M("button",{type:"button",onClick:()=>ei.value=!1,children:"Close"})]})}const Ib={findings:"Findings",frames:"Frames",detections:"Detections"},Nb=()=>({findings:jn.value.length,frames:re.frames.length,detections:re.detections.length});function Ub(){return M("section",{class:"panel list","aria-label":"Lists",children:[M("div",{class:"tabs",role:"tablist","aria-label":"What is listed",onKeyDown:Fb,children:Ss.map(n=>M("button",{role:"tab",id:`tab-${n}`,type:"button","aria-selected":Ms.value===n,"aria-controls":"listed",tabIndex:Ms.value===n?0:-1,onClick:()=>wp(n),children:[Ib[n]," ",M("span",{class:"count",children:Nb()[n]})]},n))}),M("div",{id:"listed",class:"listed",role:"tabpanel","aria-labelledby":`tab-${Ms.value}`,children:Ms.value==="findings"?M(Ob,{}):Ms.value==="frames"?M(Hb,{}):M(Gb,{})})]})}function Fb(n){const e=n.key==="ArrowRight"?1:n.key==="ArrowLeft"?-1:0;if(!e)return;n.preventDefault(),n.stopPropagation();const t=Ss[(Ss.indexOf(Ms.value)+e+Ss.length)%Ss.length];wp(t),document.getElementById(`tab-${t}`)?.focus()}function rf(n){const e=li(null);return or(()=>e.current?.scrollIntoView({block:"nearest"}),[n]),t=>{t&&(e.current=t)}}function Ob(){const n=fa.value,e=rf(Pe.value.d);return jn.value.length?M(ht,{children:[M(zb,{shown:n.length}),M("ul",{class:"rows",children:n.map(t=>{const i=He.value?.id===t.id,r=qu.value.get(t.id),s=Jo.get(t.id)?.length??t.events.length;return M("li",{children:M("button",{type:"button",class:"row","aria-current":i,ref:i?e:null,onClick:()=>Li(t.id),children:[M(tb,{finding:t}),M("span",{class:"what",children:[M("span",{class:"head",children:[M(sl,{label:t.label})," ",M("b",{children:wt(t.id)})," ",M("bdi",{class:"label",children:t.label}),r&&M("span",{class:`review ${r}`,children:r})]}),M("span",{class:"facts",children:[M("span",{children:[t.length!==null&&t.length!==void 0?"length":"size"," ",vn(t.length??t.size,t.length===null||t.length===void 0?t.size_sigma:t.length_sigma,t.length_unit??t.size_unit??re.model.unit,pn.value)]}),M("span",{children:["blade ",Ll(t.blade)]}),M("span",{title:`Detected in ${t.persistence.k} of the ${t.persistence.n} frames that could show it`,children:["seen ",t.persistence.k,"/",t.persistence.n]}),M("span",{children:[s," ",s===1?"visit":"visits"]})]})]}),M("span",{class:`sure ${t.confidence?Pl(t.confidence.value):""}`,children:t.confidence?M(ht,{children:[cr(t.confidence.value),M("small",{children:Pl(t.confidence.value)})]}):M("small",{children:"no confidence"})})]})},t.id)})})]}):M(Bb,{})}function Bb(){const n=new Map;for(const e of re.detections)e.state==="unplaced"&&n.set(e.reason??"unknown",(n.get(e.reason??"unknown")??0)+1);return M("div",{class:"empty",children:[M("p",{children:M("b",{children:"No finding is on the surface."})}),re.message&&M("p",{children:re.message}),re.detections.length===0?M("p",{children:"The annotations hold no detection inside the video."}):M("p",{children:[kb(re.detections.length,"detection")," read. ",n.size>0&&"Without a place:"]}),M("ul",{children:[...n].sort((e,t)=>t[1]-e[1]).map(([e,t])=>M("li",{children:[t,": ",ur(re,e)]},e))}),re.models.length>0&&M("p",{children:"The findings of other models are on their own pages, linked above."})]})}function kb(n,e){return`${n} ${e}${n===1?" was":"s were"}`}function zb({shown:n}){const e=r=>s=>{Rr.value={...Rr.value,[r]:s.currentTarget.value}},t=[...new Set(re.defects.map(r=>r.label))].sort(),i=[...new Set(re.defects.map(r=>String(r.blade??"")).filter(Boolean))].sort((r,s)=>r.localeCompare(s,"en",{numeric:!0}));return M("div",{class:"filters",children:[M("label",{children:["Sort",M("select",{value:Wu.value,onChange:r=>Wu.value=r.currentTarget.value,children:Object.entries(dy).map(([r,s])=>M("option",{value:r,children:s},r))})]}),M("button",{type:"button",class:"square",onClick:()=>la.value=!la.value,"aria-label":la.value?"Largest first; sort the other way":"Smallest first; sort the other way",children:la.value?"↓":"↑"}),M("label",{children:["Label",M("select",{value:Rr.value.label,onChange:e("label"),children:[M("option",{value:"",children:"all"}),t.map(r=>M("option",{value:r,children:r},r))]})]}),i.length>0&&M("label",{children:["Blade",M("select",{value:Rr.value.blade,onChange:e("blade"),children:[M("option",{value:"",children:"all"}),i.map(r=>M("option",{value:r,children:r},r))]})]}),M("label",{children:["Confidence",M("select",{value:Rr.value.confidence,onChange:e("confidence"),children:[M("option",{value:"",children:"any"}),M("option",{value:"0.4",children:"at least medium"}),M("option",{value:"0.75",children:"high"})]})]}),M("label",{children:["Review",M("select",{value:Rr.value.review,onChange:e("review"),children:[M("option",{value:"",children:"any"}),M("option",{value:"open",children:"open"}),M("option",{value:"accepted",children:"accepted"}),M("option",{value:"rejected",children:"rejected"}),M("option",{value:"merged",children:"merged"})]})]}),M("output",{"aria-live":"polite",children:[n," of ",jn.value.length]})]})}function Hb(){const n=rf(Pe.value.f),e=re.frames.filter(t=>t.registered).length;return M(ht,{children:[M("p",{class:"note",children:[e," of ",re.frames.length," frames have a camera in this model."]}),M("ul",{class:"rows",children:Pt.map(t=>{const i=Ri.value?.index===t.index,r=Ji.get(t.index)?.length??0;return M("li",{children:M("button",{type:"button",class:"row slim","aria-current":i,ref:i?n:null,onClick:()=>ni(t.index),children:[M(al,{frame:t,width:48}),M("span",{class:"what",children:[M("span",{class:"head",children:[M("b",{children:["Frame ",t.source_index]})," ",re.videos.length>1&&M("span",{children:["video ",t.video]})," ",M("span",{children:_n(t.time_s)})]}),M("span",{class:"facts",children:[M("span",{children:r?`${r} ${r===1?"detection":"detections"}`:"no detection"}),!t.registered&&M("span",{class:"warn",children:["not registered: ",ur(re,t.reason??"not_registered")]})]})]})]})},t.index)})})]})}function Gb(){const n=rf(Pe.value.n),e=re.detections.filter(i=>i.state==="unplaced").length,t=jo.value?re.detections.filter(i=>i.state==="unplaced"):re.detections;return M(ht,{children:[M("div",{class:"filters",children:[M("label",{class:"check",children:[M("input",{type:"checkbox",checked:jo.value,onChange:()=>jo.value=!jo.value})," without a place (",e,")"]}),M("output",{"aria-live":"polite",children:[t.length," of ",re.detections.length]})]}),M("ul",{class:"rows",children:t.map(i=>{const r=ys.value?.id===i.id;return M("li",{children:M("button",{type:"button",class:"row slim","aria-current":r,ref:r?n:null,onClick:()=>$u(i.id),children:[M(nb,{detection:i}),M("span",{class:"what",children:[M("span",{class:"head",children:[M(sl,{label:i.label,px:12})," ",M("bdi",{class:"label",children:i.label})," ",i.time_s!==void 0&&M("span",{children:_n(i.time_s)})," ",i.defect!==null&&M("b",{children:["D",i.defect]})]}),M("span",{class:"facts",children:M("span",{class:i.state==="mapped"?"":"warn",children:[i.state,i.reason?`: ${ur(re,i.reason)}`:""]})})]})]})},i.id)})})]})}function Vb(){if(Er.value===null)return null;const n=Zo.find(({number:e})=>e===Er.value)?.name??Er.value;return M("button",{type:"button",onClick:()=>mn({b:null},!0),children:["Only blade ",n," is shown: show all"]})}const Lr=Ve(800),ol=124,ir=18,ll=46,Wb=36,cl=Math.max(br[br.length-1]??0,.001),gn=(n,e)=>ol+((br[n]??0)+e)/cl*(Lr.value-ol-12),$b=Pt.map((n,e)=>{const t=Pt[e+1];return t&&t.video===n.video?t.time_s-n.time_s:cl-(br[n.video]??0)-n.time_s||.05});function Xb(){const n=li(null);or(()=>{const i=n.current;if(!i)return;const r=()=>{Lr.value=Math.max(240,i.clientWidth)},s=new ResizeObserver(r);return s.observe(i),r(),()=>s.disconnect()},[]),or(()=>{const i=fa.peek().findIndex(a=>a.id===He.peek()?.id),r=n.current;if(!r||i<0)return;const s=ll+ir*i;(s<r.scrollTop||s+ir>r.scrollTop+r.clientHeight)&&(r.scrollTop=s-r.clientHeight/2)},[He.value]);const e=Ri.value,t=ll+ir*Math.max(1,fa.value.length)+6;return M("section",{class:"panel timeline","aria-label":"Timeline",children:[M("div",{class:"bar",children:[M("h2",{children:"Timeline"}),M("button",{type:"button","aria-pressed":ji.value,onClick:()=>Yu(),title:"Play (P)",children:ji.value?"Stop":"Play"}),M("span",{class:"time",children:e?`${_n(e.time_s)}, frame ${e.source_index}`:"no frame"}),M("span",{class:"key",children:[M("i",{class:"swatch registered"})," registered ",M("i",{class:"swatch lost"})," not registered ",M("i",{class:"swatch detected"})," detection ",M("i",{class:"swatch visit"})," visit to a finding"]})]}),M("div",{class:"tracks",ref:n,tabIndex:0,role:"slider","aria-label":"Playhead","aria-orientation":"horizontal","aria-valuemin":0,"aria-valuemax":Math.max(0,Pt.length-1),"aria-valuenow":e?Qi.get(e.index)??0:0,"aria-valuetext":e?`Frame ${e.source_index}, ${_n(e.time_s)}`:"no frame",onKeyDown:Qb,onPointerDown:sm,onPointerMove:i=>i.buttons===1&&sm(i),children:M("svg",{width:Lr.value,height:t,"aria-hidden":"true",children:[M(qb,{height:t,wide:Lr.value}),M(Yb,{chosen:He.value?.id??null,rows:fa.value,wide:Lr.value}),e&&M("path",{class:"playhead under",d:`M${gn(e.video,e.time_s)} 4V${t}`}),e&&M("path",{class:"playhead",d:`M${gn(e.video,e.time_s)} 4V${t}M${gn(e.video,e.time_s)-5} 2h10l-5 8z`})]})})]})}function rm(n){let e=null;return t=>{const i=Object.keys(t);return(!e||i.some(r=>e?.props[r]!==t[r]))&&(e={props:t,drawn:n(t)}),e.drawn}}const qb=rm(({height:n})=>M("g",{children:[M("defs",{children:M("pattern",{id:"lost",width:"6",height:"6",patternUnits:"userSpaceOnUse",patternTransform:"rotate(45)",children:[M("rect",{width:"6",height:"6",fill:"#fff"}),M("rect",{width:"3",height:"6",fill:"#d98c1f"})]})}),M(Kb,{height:n}),M("text",{class:"lane",x:"4",y:"27",children:"cameras"}),M("text",{class:"lane",x:"4",y:"41",children:"detections"}),Pt.map((e,t)=>M("rect",{class:e.registered?"registered":"lost",x:gn(e.video,e.time_s),y:"18",width:Math.max(1,gn(e.video,e.time_s+($b[t]??0))-gn(e.video,e.time_s)),height:"11",children:!e.registered&&M("title",{children:`Frame ${e.source_index}: ${ur(re,e.reason??"not_registered")}`})},e.index)),Pt.map(e=>{const t=Ji.get(e.index)??[];if(!t.length)return null;const i=t.every(r=>r.state==="mapped");return M("rect",{class:i?"detected":"detected some",x:gn(e.video,e.time_s)-1,y:"33",width:"2.4",height:"8",children:M("title",{children:`${t.length} detections in frame ${e.source_index}${i?"":", some without a place"}`})},`n${e.index}`)})]})),Yb=rm(({chosen:n,rows:e,wide:t})=>M("g",{children:[e.map((i,r)=>{const s=ll+ir*r,a=Ki.get(i.label);return M("g",{class:n===i.id?"track chosen":"track",children:[n===i.id&&M("rect",{class:"ground",x:"0",y:s,width:t,height:ir}),M("path",{class:"mark",transform:`translate(11 ${s+ir/2}) scale(5)`,d:a?.shape??"",fill:a?.css??"gray"}),M("text",{class:"lane",x:"21",y:s+13,"data-finding":i.id,children:Jb(`${wt(i.id)} ${i.label}`)}),(Jo.get(i.id)??[]).map(o=>{const l=gn(o.video??0,o.start_s);return M("rect",{class:"visit","data-finding":i.id,"data-time":o.start_s,x:l-2,y:s+3,width:Math.max(5,gn(o.video??0,o.end_s)-l+4),height:ir-6,rx:"3",style:{fill:a?.css??"gray"},children:M("title",{children:`${wt(i.id)} from ${_n(o.start_s)} to ${_n(o.end_s)}: ${o.n_detections} detections`})},o.event_id)}),i.detections.map(o=>{const l=Zi.get(Ai.get(o)?.frame??-1);return l?M("rect",{class:"tick",x:gn(l.video,l.time_s)-.6,y:s+5,width:"1.2",height:ir-10},o):null})]},`d${i.id}`)}),!e.length&&M("text",{class:"lane",x:ol,y:ll+13,children:"No finding has a visit here."})]}));function Kb({height:n}){const e=[.5,1,2,5,10,20,30,60,120,300,600,1800].find(i=>cl/i<=Math.max(4,Lr.value/90))??3600,t=[];for(let i=0;i<br.length-1;i++){const r=(br[i+1]??cl)-(br[i]??0);i&&t.push(M("path",{class:"border",d:`M${gn(i,0)} 0V${n}`},`v${i}`));for(let s=0;s<=r+1e-6;s+=e){const a=gn(i,s),o=a>Lr.value-Wb;t.push(M("g",{children:[M("path",{class:"grid",d:`M${a} 14V${n}`}),M("text",{class:"scale",x:o?a-2:a+2,y:"12","text-anchor":o?"end":"start",children:re.videos.length>1&&s===0?`video ${i}`:`${Number(s.toFixed(1))} s`})]},`${i}-${s}`))}}return M(ht,{children:t})}function Zb(n){const e=Pt.filter(t=>Ji.get(t.index)?.some(i=>i.defect===n));return e.length?new Set(e.map(t=>t.index)):null}function Jb(n){return n.length>14?`${n.slice(0,13)}…`:n}function Qb(n){const t={ArrowLeft:()=>ii(-1),ArrowDown:()=>ii(-1),ArrowRight:()=>ii(1),ArrowUp:()=>ii(1),PageDown:()=>ii(-10),PageUp:()=>ii(10),Home:()=>ni(Pt[0]?.index??null),End:()=>ni(Pt[Pt.length-1]?.index??null)}[n.key];!t||n.ctrlKey||n.metaKey||n.altKey||(n.preventDefault(),n.stopPropagation(),t())}function sm(n){const e=n.currentTarget.getBoundingClientRect(),t=n.clientX-e.left,i=n.target,r=n.type==="pointerdown"?i.getAttribute("data-finding"):null;let s=null,a=1/0;const o=r!==null&&i.hasAttribute("data-time")?Zb(Number(r)):null;for(const l of Pt){if(o&&!o.has(l.index))continue;const c=Math.abs(gn(l.video,l.time_s)-t);c<a&&([s,a]=[l.index,c])}if(r!==null){const l=i.hasAttribute("data-time");Li(Number(r),l&&s!==null?{frame:s}:{});return}if(!(t<ol-8||s===null)){if(n.type==="pointerdown"&&n.offsetY>30&&n.offsetY<43){const l=Ji.get(s)?.[0];if(l)return $u(l.id)}ni(s,!0)}}const jb={ok:"ok: the checks found nothing that speaks against the model",suspect:"suspect: read the warnings before you trust a place or a size",refused:"refused: no model can be trusted"};function eE(){return Yo?M("main",{class:"broken",children:[M("h1",{children:"Nothing can be shown"}),M("p",{role:"alert",children:Yo})]}):M(ht,{children:[M(tE,{}),M("main",{class:"grid",children:[M("div",{class:"side",children:[M(Ub,{}),M(Tb,{})]}),M(qy,{}),M(rb,{}),M(Xb,{})]}),M("p",{class:"spoken","aria-live":"polite",children:ti.value}),M(Db,{})]})}function tE(){const{title:n,verdict:e,message:t,flags:i,model:r,models:s}=re,a=i.filter(o=>o.severity!=="info");return M("header",{children:[M("h1",{children:M("bdi",{children:n})}),M("p",{class:"lead",children:[M("span",{class:`verdict ${e}`,title:jb[e]??"",children:e})," ",re.defects.length," ",re.defects.length===1?"finding":"findings",nE(r.findings),", ",re.detections.length," ",re.detections.length===1?"detection":"detections",", ",re.frames.length," frames",r.unit==="model"?", unscaled":`, in ${pn.value==="in"?"inches":r.unit}`]}),s.length>0&&M("nav",{"aria-label":"Models",children:[M("span",{children:["Model ",r.index," of ",r.count,"; the others: "]}),s.map(o=>M("a",{href:iE(o.href),children:["model ",o.index]},o.index))]}),M(Vb,{}),(i.length>0||t)&&M("details",{class:"flags",open:e==="refused",children:[M("summary",{children:a.length||i.length?`${i.length} ${i.length===1?"remark":"remarks"} of the checks`:"What happened"}),t&&M("p",{children:t}),M("ul",{children:i.map((o,l)=>M("li",{class:o.severity,children:[M("b",{children:o.severity})," ",o.text,o.where?` (${o.where})`:"",".",o.advice?` ${o.advice}`:""]},l))})]}),r.unit==="mm"&&M("label",{class:"units",children:["Lengths in"," ",M("select",{value:pn.value,onChange:o=>gy(o.currentTarget.value),children:[M("option",{value:"mm",children:"mm"}),M("option",{value:"in",children:"inches"})]})]}),M("button",{type:"button",class:"help",onClick:()=>ei.value=!0,"aria-label":"Keys",title:"Keys (?)",children:"?"})]})}function nE(n){return n?` here (${n[0]} to ${n[1]} in all models)`:""}function iE(n){return/^(\.\.\/)*[\w./-]+$/.test(n)&&!n.startsWith("/")?n:"#"}vy();const sf=document.getElementById("app");sf&&(sf.replaceChildren(),bm(M(eE,{}),sf)),vb();const rE={ready:!0,place:()=>Pe.peek(),pointAt:(n,e,t)=>lt.pointAt(n,e,t),visibleFrames:n=>{const e=St?.nearest(n);return e?lt.visibleFrames(e.point,e.normal):[]},silhouette:(n,e,t)=>Array.from(Jp(document.createElement("canvas"))?.silhouette(n,e,t)??[]).join(""),camera:()=>Tn.peek()?.orbit.numbers??null,onCanvas:n=>Tn.peek()?.screen(n,!0)??null,findings:re.defects.length};window.bladeatlas=rE})();
